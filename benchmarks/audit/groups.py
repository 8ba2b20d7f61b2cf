"""Is the source of an oscillation found that spreads? 100 simulated plants, and the Tennessee Eastman plant.

Run: ``.venv/bin/python benchmarks/audit/groups.py`` (about 30 minutes on one thread); prints a section of a page, and
goes on where it was when it is started again: the rows of each plant are kept in a store, by the version of the code
that decides about loops, so that another way to find groups and sources takes seconds. ``--plants N`` for fewer,
``--screen-only`` without diagnoses (a tenth of the time), ``--eastman`` for that plant too, which is installed into
``.venv-tep``; ``--chance`` compares loops of different plants instead, of all that are in the store: they share
nothing.

A plant has 8 to 20 loops and one source that swings and reaches at least two others: 60 % worn valves (two thirds
stiction, one third backlash), 20 % tight loops, 20 % from outside. What it reaches is known from the same plant with
the same luck without the source. Found: the right loop is named, or none where it comes from outside. Masters of
cascades are told from the data, as ``lostmotion audit --propose`` does, and not diagnosed.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported
sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import argparse  # noqa: E402
import hashlib  # noqa: E402
import json  # noqa: E402
import time  # noqa: E402
from collections import Counter  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from dataclasses import asdict, dataclass, replace  # noqa: E402
from datetime import timedelta  # noqa: E402
from itertools import combinations, pairwise  # noqa: E402
from typing import Any  # noqa: E402

import numpy as np  # noqa: E402
import swinging_plants  # noqa: E402
from swinging_plants import SOURCES, swinging_plant  # noqa: E402

from lostmotion.audit.assess.assess import assess  # noqa: E402
from lostmotion.audit.groups.groups import groups  # noqa: E402
from lostmotion.audit.groups.swinging import LEAST_SHARED, LEVEL, NEAR_PERIOD, swinging  # noqa: E402
from lostmotion.audit.runner.code import code_version  # noqa: E402
from lostmotion.audit.runner.plan import loop_row  # noqa: E402
from lostmotion.audit.screen.screen import screen  # noqa: E402
from lostmotion.audit.settings import AuditSettings  # noqa: E402
from lostmotion.evaluate.plants.plant import BEGAN, OUTSIDE  # noqa: E402
from lostmotion.plant import PlantLoop  # noqa: E402
from lostmotion.plant.cascades import Cascades  # noqa: E402
from lostmotion.records import LoopRecord  # noqa: E402
from lostmotion.store.rows import AssessmentRow, GroupRow, SpectrumRow  # noqa: E402
from lostmotion.store.run_rows import RunRow, RunState  # noqa: E402
from lostmotion.store.store import Screened, Store  # noqa: E402
from pages.commit import ROOT  # noqa: E402
from pages.publish import STORE  # noqa: E402

KEPT = ROOT / STORE / "audit-groups.db"
PLANTS, FAMILY = 100, 0
NEAR = NEAR_PERIOD  # of the period: the group that is meant
CYCLES = (3.0, 15.0, 30.0, 60.0, np.inf)
ENDS = ("found", "cannot tell", "wrong", "no group")
Rows = tuple[list[AssessmentRow], list[SpectrumRow]]


def rows_of(loops: Sequence[PlantLoop], records: Sequence[LoopRecord], diagnosed: bool) -> Rows:
    """Rows of an audit of whole records: all are screened; what swings steadily and has a valve is assessed."""
    rows, spectra, settings = [], [], AuditSettings()
    for loop, record in zip(loops, records, strict=True):
        end = BEGAN + timedelta(seconds=len(record) * record.dt)
        row, spectrum = screen(loop, record, BEGAN, end, settings)
        if diagnosed and row.fit_for_use and (row.regularity or 0.0) > 1.0 and not loop.slave:
            row, _ = assess(loop, record, row, settings)
        rows.append(row)
        spectra += [] if spectrum is None else [spectrum]
    return rows, spectra


def with_slaves(loops: Sequence[PlantLoop], records: Sequence[LoopRecord]) -> list[PlantLoop]:
    """Loops with the slaves of those that are masters by their data."""
    seen = Cascades()
    for loop, record in zip(loops, records, strict=True):
        seen.add(loop.tag, record)
    slaves = seen.slaves()
    return [replace(loop, slave=slaves.get(loop.tag, "")) for loop in loops]


def the_group(found: Sequence[GroupRow], period: float, reached: set[str]) -> GroupRow | None:
    """The group that is meant: of that period, with most of the loops that the source reaches."""
    near = [one for one in found if abs(np.log(one.period / period)) < NEAR]
    count = {id(one): len({member[0] for member in one.members} & reached) for one in near}
    best = max(near, key=lambda one: count[id(one)], default=None)
    return best if best is not None and count[id(best)] > 1 else None


def outcome(group: GroupRow | None, source: str) -> str:
    """Of ENDS."""
    if group is None:
        return "found" if source == OUTSIDE else "no group"
    if group.source:
        return "found" if group.source == source else "wrong"
    return "found" if source == OUTSIDE else "cannot tell"


@dataclass(frozen=True)
class Truth:
    """What is true of a plant; `source` is a tag or "outside", `period` in seconds.

    `slaves` are those that the data tell, by the tags of their masters.
    """

    kind: str
    source: str
    period: float
    reached: tuple[str, ...]
    seconds: float
    slaves: dict[str, str]

    @property
    def loops(self) -> dict[str, PlantLoop]:
        """What is known of the masters."""
        return {tag: PlantLoop(tag, slave=slave) for tag, slave in self.slaves.items()}


def kept_run(store: Store, number: int, family: int, diagnosed: bool) -> tuple[int, Truth]:
    """Run of the store with the rows of one plant, and its truth; made where today's code has not done it before."""
    drawn = hashlib.sha256(Path(swinging_plants.__file__).read_bytes()).hexdigest()[:8]
    how = f"{'diagnosed' if diagnosed else 'screened'} {drawn}, masters not"
    wanted = RunRow(f"plant {number} of family {family}", digest=how, code=code_version())
    for one in store.runs():
        if (one.source, one.digest, one.code, one.state) == (wanted.source, how, wanted.code, RunState.FINISHED):
            return one.number, Truth(**json.loads(one.settings))
    begin = time.process_time()
    made = swinging_plant(number, family)
    records = list(made.plant.records())
    loops = with_slaves(made.plant.plant_loops(), records)
    rows, spectra = rows_of(loops, records, diagnosed)
    found, seconds = made.spread, time.process_time() - begin
    slaves = {loop.tag: loop.slave for loop in loops if loop.slave}
    truth = Truth(made.kind, found.source, found.period, found.reached, seconds, slaves)
    run, _ = store.begin(replace(wanted, settings=json.dumps(asdict(truth))), resume=False)
    store.put_loops(run, [loop_row(loop) for loop in loops])
    of_tag = {one.tag: (one,) for one in spectra}
    store.put_screened(run, [Screened((row,), of_tag.get(row.tag, ())) for row in rows])
    store.finish(run)
    return run, truth


def measured(store: Store, number: int, family: int, diagnosed: bool) -> dict[str, Any]:
    """One plant."""
    run, truth = kept_run(store, number, family, diagnosed)
    found, reached = groups(store.spectra(run), store.rows(run), truth.loops), set(truth.reached)
    group = the_group(found, truth.period, reached)
    members = set() if group is None else {member[0] for member in group.members}
    return asdict(truth) | {
        "end": outcome(group, truth.source), "why": group.why if group else "",
        "members": sorted(members), "both": len(members & reached),
        "others_named": sum(bool(one.source) for one in found if one is not group and one.source != truth.source),
    }  # fmt: skip


def by_chance(store: Store) -> list[str]:
    """Loops of different plants that swing with about one period: how many would be taken for members of a group."""
    plants = [one.number for one in store.runs() if one.state is RunState.FINISHED and one.code == code_version()]
    loops = [(run, one) for run in plants for one in swinging(store.spectra(run), store.rows(run), {})]
    found = [
        (min(one.cycles, other.cycles), one.shared(other, one.period))
        for (run, one), (another, other) in combinations(loops, 2)
        if run != another and abs(np.log(one.period / other.period)) <= NEAR_PERIOD
    ]
    lines = [
        f"| periods | pairs | chance 0.5 and less | {LEVEL} and less | that, and coherent |",
        "|---|---|---|---|---|",
    ]
    for low, high in (*pairwise(CYCLES), (CYCLES[0], CYCLES[-1])):
        mine = [shared for cycles, shared in found if low <= cycles < high]
        less = [sum(one.chance <= level for one in mine) for level in (0.5, LEVEL)]
        taken = sum(one.chance <= LEVEL and one.coherence >= LEAST_SHARED for one in mine)
        shares = " | ".join(f"{100.0 * count / max(len(mine), 1):.2f} %" for count in (*less, taken))
        lines.append(f"| {low:g} to {high:g} | {len(mine)} | {shares} |")
    return lines


def eastman(diagnosed: bool) -> list[str]:
    """Tennessee Eastman with its sticking valve: groups, and what the loop of the valve gets."""
    from plant.runs import loops  # noqa: PLC0415  an environment of its own

    runs = loops(14, 8.0, 1)
    tags = [PlantLoop(tag=one.record.tag, op_span=(0.0, 100.0)) for one in runs]
    records = [LoopRecord(one.record.op, one.record.pv, one.record.sp, dt=one.record.dt, start=BEGAN) for one in runs]
    rows, spectra = rows_of(tags, records, diagnosed)
    lines = ["", "| group | period, s | source | members, most suspect first |", "|---|---|---|---|"]
    for one in groups(spectra, rows):
        names = ", ".join(dict.fromkeys(member[0] for member in one.members))
        lines.append(f"| {one.number} | {one.period:.0f} | {one.source or 'cannot tell'} | {names} |")
    lines += ["", "| loop | sticks | verdict | probability |", "|---|---|---|---|"]
    for run, row in zip(runs, rows, strict=True):
        sure = "-" if row.probability is None else f"{row.probability:.2f}"
        lines.append(f"| {row.tag} | {'yes' if run.sticks else 'no'} | {row.verdict} | {sure} |")
    return lines


def section(results: Sequence[dict[str, Any]]) -> list[str]:
    """Tables."""
    lines = [f"| source | plants | {' | '.join(ENDS)} |", "|---|---|" + "---|" * len(ENDS)]
    for kind in (*dict.fromkeys(SOURCES), "all"):
        mine = [one["end"] for one in results if kind in (one["kind"], "all")]
        counts = Counter(mine)
        lines.append(f"| {kind} | {len(mine)} | {' | '.join(str(counts[end]) for end in ENDS)} |")
    whole = sum(len(one["reached"]) for one in results)
    lines += [
        "",
        f"Loops that the sources reach: {whole}; of them in the group {sum(one['both'] for one in results)}; others in "
        f"it {sum(len(one['members']) - one['both'] for one in results)}. Other groups in which a loop is named: "
        f"{sum(one['others_named'] for one in results)}.",
    ]
    return lines


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plants", type=int, default=PLANTS)
    parser.add_argument("--family", type=int, default=FAMILY, help="others than 0 are for development")
    parser.add_argument("--screen-only", action="store_true")
    parser.add_argument("--eastman", action="store_true")
    parser.add_argument("--chance", action="store_true")
    given = parser.parse_args()
    results = []
    KEPT.parent.mkdir(parents=True, exist_ok=True)
    with Store(KEPT) as store:
        if given.chance:
            print("\n".join(by_chance(store)))
            return
        for number in range(given.plants):
            one = measured(store, number, given.family, not given.screen_only)
            results.append(one)
            print(number, one["kind"], one["source"], one["end"], one["why"], f"{one['seconds']:.0f} s", flush=True)
    print("\n".join(section(results)))
    if given.eastman:
        print("\n".join(eastman(not given.screen_only)))


if __name__ == "__main__":
    main()
