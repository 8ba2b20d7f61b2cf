"""Verdicts of the diagnosis on loops of a base case in which one ingredient is changed at a time.

Run: ``.venv/bin/python benchmarks/ingredients.py`` (about 15 minutes on two cores); writes docs/ingredients.md: 664
loops of 55 ingredients, from a simulation that shares nothing with the package. ``--ingredients base,pid``: these
alone; ``--loops N``: of each; ``--workers N``. Others than by default are printed, not written.

A fault that OP goes through fewer than three times is in no count but that of those left out. Where OP stands at an end
of its span a "saturation" of a sound valve is no accusation: the product calls it so.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import warnings  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from pathlib import Path  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from one_ingredient import page  # noqa: E402
from one_ingredient.changes import CHANGES, SEEDS_APART, seeds_of  # noqa: E402
from one_ingredient.judge import Judged, judged  # noqa: E402
from one_ingredient.loops import loop_of  # noqa: E402
from pages import publish  # noqa: E402
from pages.written import told  # noqa: E402

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "ingredients.md"
LOOPS = 12  # of an ingredient: each kind of valve that is drawn

ABOUT = """\
# One ingredient changed at a time

Made by `.venv/bin/python benchmarks/ingredients.py`. {loops} simulated loops. In the base case a PI controller, tuned
by one of three rules in use, holds a process of one or two lags with dead time under a slow load and noise, and its set
point goes in steps. The valve is sound, or has backlash, stiction (five models of friction) or a dead zone of 1 to 8 %
of OP, or a stroke that ends too early. An ingredient changes one thing of it, and leaves all else as it was drawn or as
follows from the change. Nothing of the package is in the simulation, and no weight was fitted on it; some rules of
[diagnosis.md](diagnosis.md) were made because of it, so it is no longer unseen.
"""
SOUND = """\
## Valves without a fault

Said to be sound: "none" or "other oscillation". OP at an end of its span for a tenth of the rows is a "saturation" to
the product, whatever the valve: of the ingredient `clamped` that is counted as "at its limit".
"""
FAULTY = """\
## Valves with a fault

Counted where OP goes through the fault at least three times: turns by more than 1.2 of its size, crosses the dead zone,
or runs 1 % beyond the end of the stroke. Intervals are those of any lost motion named; bounds are the sizes above which
the true kind is said to be excluded.
"""
CLAIMS = """\
## Claims

Verdicts but "cannot tell", by the probability claimed that there is a fault of the valve, or none.
"""
WRONG = """\
## Wrong decisions

Faults cleared, sound valves accused, and bounds more than a tenth below the truth, also of faults that OP hardly meets.
"""


def diagnosed(job: tuple[str, int]) -> Judged:
    """Simulate, diagnose and judge the loop of this ingredient and seed."""
    loop = loop_of(*job)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return judged(loop, lm.diagnose(loop.record))
    except lm.InputError:
        return judged(loop, None)


def page_of(found: Sequence[Judged]) -> str:
    """The page."""
    parts = [
        *(ABOUT.format(loops=len(found)), *page.summary(found)),
        *(SOUND, *page.sound_valves(found)),
        *(FAULTY, *page.faulty_valves(found)),
        *(CLAIMS, *page.claims(found)),
        *(WRONG, *page.wrong_decisions(found)),
    ]
    return "\n".join(parts).rstrip()


def main() -> None:
    """Diagnose and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ingredients", default=",".join(CHANGES), metavar="A,B", help="names; all unless given")
    parser.add_argument(
        "--loops", type=int, default=LOOPS, help=f"of each ingredient, {LOOPS} unless given; twice as many of the base"
    )
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    names = list(dict.fromkeys(given.ingredients.split(",")))
    if unknown := [name for name in names if name not in CHANGES]:
        parser.error(f"expected names of ingredients, got {', '.join(unknown)}; there are {', '.join(CHANGES)}")
    if not 1 <= given.loops <= SEEDS_APART // 2:
        parser.error(f"expected 1 to {SEEDS_APART // 2} loops, got {given.loops}: beyond, seeds would be used twice")
    jobs = [(name, seed) for name in names for seed in seeds_of(name, given.loops)]
    said = page_of(run_all(diagnosed, jobs, "loops", given.workers, told))
    if names == list(CHANGES) and given.loops == LOOPS:
        publish(OUTPUT, said + "\n")
    else:
        print(said)


if __name__ == "__main__":
    main()
