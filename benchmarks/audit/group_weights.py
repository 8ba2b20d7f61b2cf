"""Fits the weights by which the likely source of a group is told, on simulated plants of families 1 and 2.

Run: ``.venv/bin/python benchmarks/audit/group_weights.py`` behind ``benchmarks/audit/groups.py --family 1 --plants 38``
and ``--family 2 --plants 60``, whose rows it finds in their store; seconds. Prints the weights of
``audit/groups/likely_source.py``, and what they find in plants left out of eight parts.

The source is one of the members of a group or none of them: a conditional logit (McFadden 1974), drawn towards 1 for
what is log odds already, towards 0 for what is not. Family 0, by which the page judges, is not looked at.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import json  # noqa: E402
from collections import Counter  # noqa: E402
from collections.abc import Iterator, Sequence  # noqa: E402
from dataclasses import dataclass  # noqa: E402

import numpy as np  # noqa: E402
from groups import ENDS, KEPT, NEAR, OUTSIDE, Truth  # noqa: E402
from scipy.optimize import minimize  # noqa: E402

from lostmotion.arrays import FloatArray  # noqa: E402
from lostmotion.audit.groups import likely_source  # noqa: E402
from lostmotion.audit.groups.groups import suspects_of  # noqa: E402
from lostmotion.store.run_rows import RunState  # noqa: E402
from lostmotion.store.store import Store  # noqa: E402

FAMILIES, PARTS = (1, 2), 8
NAMES, NONE = tuple(likely_source.WEIGHTS), tuple(likely_source.OUTSIDE)
TOWARDS = {"valve": 1.0, "tuning": 1.0, "no fault named": 1.0, "purity": 1.0}
STIFF = 1.0  # squares of log odds


@dataclass(frozen=True)
class Case:
    """One group: what is known of its members (m, facts) and of the outside, which of them it is (m: none)."""

    kind: str
    members: FloatArray
    outside: FloatArray
    named: tuple[bool, ...]
    source: int


def cases(store: Store) -> Iterator[Case]:
    """Groups of the plants in which the oscillation of the source has made one."""
    for run in store.runs():
        words = run.source.split()
        if run.state is not RunState.FINISHED or int(words[-1]) not in FAMILIES:
            continue
        truth = Truth(**json.loads(run.settings))
        found = suspects_of(store.spectra(run.number), store.rows(run.number), truth.loops)
        near = [one for period, one in found if abs(np.log(period / truth.period)) < NEAR]
        reached = set(truth.reached)
        best = max(near, key=lambda one: len({each.loop.tag for each in one} & reached), default=())
        tags = [one.loop.tag for one in best]
        if len(set(tags) & reached) < 2:
            continue
        members = np.array([[one.facts.get(name, 0.0) for name in NAMES] for one in best])
        outside = likely_source.facts_of_outside(best)
        source = tags.index(truth.source) if truth.source in tags else len(tags)
        named = tuple(bool(one.why) for one in best)
        yield Case(truth.kind, members, np.array([outside[name] for name in NONE]), named, source)


def shares(weights: FloatArray, case: Case) -> FloatArray:
    """Probability of each member, and of none of them."""
    inside, outside = weights[: len(NAMES)], weights[len(NAMES) :]
    odds = likely_source.odds_of(case.members @ inside, float(case.outside @ outside))
    return np.append(odds, max(1.0 - float(odds.sum()), 0.0))


def fitted(known: Sequence[Case]) -> FloatArray:
    """Weights of NAMES, then those of NONE."""
    start = np.array([TOWARDS.get(name, 0.0) for name in (*NAMES, *NONE)])

    def loss(weights: FloatArray) -> float:
        misfit = -sum(np.log(shares(weights, case)[case.source] + 1e-12) for case in known)
        return float(misfit + STIFF * np.sum((weights - start) ** 2))

    return np.asarray(minimize(loss, start, method="BFGS").x)


def end(weights: FloatArray, case: Case) -> str:
    """Of ENDS."""
    odds = shares(weights, case)[:-1]
    order = np.argsort(-odds)
    first = int(order[0])
    if likely_source.stands_out(odds[order], case.named[first]):
        return "found" if first == case.source else "wrong"
    return "found" if case.kind == OUTSIDE else "cannot tell"


def main() -> None:
    """Print weights and what they find in plants that were left out."""
    with Store(KEPT, write=False) as store:
        known = list(cases(store))
    weights = fitted(known)
    for name, value in zip((*NAMES, *NONE), weights, strict=True):
        print(f"{name}: {value:.2f}")
    ends: Counter[tuple[str, str]] = Counter()
    for part in range(PARTS):
        rest = fitted([case for place, case in enumerate(known) if place % PARTS != part])
        ends.update((case.kind, end(rest, case)) for case in known[part::PARTS])
    print(f"\n| left out, {len(known)} groups | {' | '.join(ENDS[:3])} |\n|---|---|---|---|")
    for kind in sorted({case.kind for case in known}):
        print(f"| {kind} | {' | '.join(str(ends[kind, one]) for one in ENDS[:3])} |")


if __name__ == "__main__":
    main()
