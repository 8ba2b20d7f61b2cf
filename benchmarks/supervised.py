"""Supervised blocks under a million scans of random supervision: laws kept, and ST, C and Python identical.

Run: ``make plc && .venv/bin/python benchmarks/supervised.py`` (about 15 minutes); writes docs/supervised.md.
Options: ``--scans N`` for a shorter run, which writes no page. Started again, it goes on after the last block that was
finished.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from itertools import pairwise
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from lostmotion.compensate.supervision_variables import REASONS, STATES, listed  # noqa: E402
from lostmotion.export import TARGETS  # noqa: E402
from lostmotion.export.dialects import restore  # noqa: E402
from lostmotion.export.replay import compare  # noqa: E402
from lostmotion.export.scenarios import Stretch  # noqa: E402
from pages import kept, publish  # noqa: E402
from tests.plc.machine import run_in_c, run_in_machine  # noqa: E402
from tests.properties.test_supervised import quiet  # noqa: E402
from tests.support.exports import KINDS, REALS  # noqa: E402
from tests.support.supervised_laws import played, random_supervision, violations  # noqa: E402

OUTPUT = ROOT / "docs" / "supervised.md"
TEMPLATE = Path(__file__).parent / "supervised.md"
SCANS = 1_000_000
PART = 125_000


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=SCANS)
    arguments = parser.parse_args()
    each = arguments.scans // (len(KINDS) * len(REALS))
    agreement, visits, laws = [], [], Counter()
    for kind in KINDS:
        for real in REALS:
            row, seen, broken = kept(
                "supervised", f"{kind} {real} {each} scans", lambda k=kind, r=real: execute(k, r, each)
            )
            agreement.append(row)
            visits.append(seen)
            laws.update(broken)
            print(row, seen, broken, sep="\n", flush=True)
    if arguments.scans == SCANS:
        broken = "\n".join(f"| {law} | {count} |" for law, count in laws.items())
        tables = {"agreement": "\n".join(agreement), "visits": "\n".join(visits), "laws": broken}
        words = {"states": listed(STATES), "reasons": listed(REASONS)}
        publish(OUTPUT, TEMPLATE.read_text(encoding="utf-8").format(**tables, **words))


def execute(kind: str, real: str, scans: int) -> tuple[str, str, dict[str, int]]:
    """Row of agreement, row of states, and scans that break each law."""
    one = quiet(kind, real)
    text, code = restore(TARGETS["st"].files(one)), TARGETS["c"].files(one)
    worst, flags, states, laws, total = 0.0, 0, Counter(), Counter(), 0
    for seed in range(max(scans // PART, 1)):
        inputs, cold = random_supervision(one, min(PART, scans), [seed, *kind.encode(), *real.encode()])
        kernel = played(one, inputs, cold)
        laws.update(violations(one, inputs, cold, kernel))
        bounds = [*np.flatnonzero(cold).tolist(), len(inputs)]
        stretches = [Stretch(one.parameters, inputs[a:b], True) for a, b in pairwise(bounds)]
        with tempfile.TemporaryDirectory() as folder:
            ways = run_in_machine(text, one, stretches), run_in_c(code, one, stretches, Path(folder))
        for proof in (compare(one, kernel, found) for found in ways):
            worst, flags = max(worst, proof.worst), flags + proof.different_flags
        names = [variable.name for variable in one.specification.section("output")]
        states.update(kernel[:, names.index("SUPERVISION")].tolist())
        total += len(kernel)
    shares = " | ".join(f"{100 * states[float(k)] / total:.2g}" for k in range(5))
    row = f"| {kind} | {real.upper()} | {total:,} | {worst:.2g} | {flags} |"
    return row, f"| {kind} | {real.upper()} | {shares} |", dict(laws)


if __name__ == "__main__":
    main()
