"""Are the faults of a made plant at the top of the ranking, and is nothing else called a fault?

Run: ``PYTHONPATH=. .venv/bin/python benchmarks/audit/ranking.py`` (3 minutes a plant on two cores).
Each plant has 50 loops of 2 days at 1 s, 10 of them with a fault (3 of 7 kinds are not of a valve), made anew in a
temporary folder and audited with the list of its loops as they come. All weights count 1: what a loop is worth is no
evidence.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import polars as pl

import lostmotion as lm
from lostmotion.audit.plant_view import FAULTS, leading_rows
from lostmotion.audit.rank import ranked
from lostmotion.evaluate.plants import random_plant
from lostmotion.evaluate.plants.truth import VALVES
from lostmotion.evaluate.plants.written import write_plant
from lostmotion.store.rows import AssessmentRow

FIRST = 12


def main() -> None:
    """Audit some plants and print what came first."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seeds", type=int, nargs="+", default=[1, 2, 3])
    asked.add_argument("--loops", type=int, default=50)
    asked.add_argument("--days", type=float, default=2.0)
    asked.add_argument("--faults", type=int, default=10)
    asked.add_argument("--moves", type=float, help="new set points a day, as `lostmotion demo-plant` makes them")
    given = asked.parse_args()
    print(
        f"| plant | faults in the first {FIRST} | valves at fault in them | named right | other loops called at fault |"
    )
    print("|---|---|---|---|---|")
    for seed in given.seeds:
        print(line(seed, given.loops, given.days, given.faults, given.moves), flush=True)


def line(seed: int, loops: int, days: float, faults: int, moves: float | None) -> str:
    """Make and audit one plant; without `moves` most set points rest, harder than that of `lostmotion demo-plant`."""
    with tempfile.TemporaryDirectory() as folder:
        where, plant = Path(folder) / "plant", random_plant(seed, loops, days, faults, swings=1, moves=moves)
        write_plant(where, plant, plant.truth(), "parquet", lambda _: None)
        truth = {one["tag"]: one for one in pl.read_csv(where / "truth.csv").to_dicts()}
        run = lm.audit(where, Path(folder) / "plant.db", loops=where / "loops.csv")
    equal = {loop.tag: replace(loop, weight=1.0) for loop in run.loops}
    return told(seed, truth, leading_rows(ranked(run.rows, equal, run.groups)))


def told(seed: int, truth: dict[str, dict[str, Any]], rows: Sequence[AssessmentRow]) -> str:
    """One line of the table, and the loops in question below it."""
    wrong = {tag for tag, one in truth.items() if one["fault"] != "none"}
    valves = {tag for tag in wrong if truth[tag]["fault"] in VALVES}
    first = [row.tag for row in rows[:FIRST]]
    named = {row.tag: row.verdict for row in rows if row.verdict in FAULTS and row.verdict != "saturation"}
    right = sum(named.get(tag) == truth[tag]["fault"] for tag in valves)
    false = sorted(set(named) - valves)
    shares = (
        f"{len(wrong & set(first))} of {len(wrong)}", f"{len(valves & set(first))} of {len(valves)}",
        f"{right} of {len(valves & set(named))}", f"{len(false)} of {len(truth) - len(valves)} {' '.join(false)}",
    )  # fmt: skip
    return f"| {seed} | {' | '.join(shares)} |"


if __name__ == "__main__":
    main()
