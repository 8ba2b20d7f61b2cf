"""What the blocks of ``lostmotion solve`` do in loops that they were made for, of a simulation of its own.

Run: ``.venv/bin/python benchmarks/blocks.py`` (about 6 minutes on two cores); writes docs/blocks.md: 108 loops of nine
kinds of valve. ``--kinds "backlash,dead zone"``: these alone; ``--loops N``: of each kind; ``--first SEED``: the first
of each kind; ``--workers N``. Others than by default are printed, not written.

Nothing of the package is in the simulation: a loop is recorded, the record is solved, and the block that comes out is
stepped in the same loop with another set point, load and noise.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import warnings  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from pathlib import Path  # noqa: E402

from block_trials import page  # noqa: E402
from block_trials.judge import Judged, judged  # noqa: E402
from block_trials.valves import KINDS  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from pages import publish  # noqa: E402
from pages.written import told  # noqa: E402

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "blocks.md"
LOOPS = dict(zip(KINDS, (9, 7, 6, 14, 20, 12, 14, 12, 14), strict=True))  # backlash: most of all in plants
FIRST = 100  # seed of each kind

ABOUT = """\
# Do the blocks help?

Made by `.venv/bin/python benchmarks/blocks.py`. {loops} simulated loops: a PI controller by SIMC, between tight and
slow, holds a flow, a temperature, a level or another process of one or two lags with dead time, under a wandering load,
steps of load or set point or both, and noise. The valve has a play or a dead zone, sticks by one of four models of
friction, or is sound; the lost motion is 1 to 8 % of OP. A run of 2000 to 6000 rows is recorded, two fifths of the
records are rounded, and `lm.solve` gets OP, PV and set point, nothing else. The block that comes out is stepped, scan
by scan, in the same loop over 10,000 rows with another set point, load and noise, beside the same rows without it and
with an ideal valve. Nothing of the package is in the simulation, and no weight was fitted on it; some rules of the
study were made because of it, so it is no longer unseen. Error: the mean of the absolute error of PV, noise included.
Ratios: with the block over without it.
"""
WAYS = """\
## How the way ended

By kind of valve: a block, the step whose gate stayed closed, or nothing wrong.
"""
GAINS = """\
## The blocks on the valves that they were made for

Medians, where a block came out. The ideal valve has the same actuator without the lost motion; the share of its gain
is taken where that is more than 5 % of the error. Made worse: an error larger by more than 5 %. The last column counts
blocks for valves without a fault, and blocks made for another kind of fault. A stiction of small jump is nearly a play.
"""
OTHERS = """\
## When the valve changes

The same blocks, unchanged, where the true lost motion is 0.8 and 1.2 of what it was, and where the valve was repaired
and the block left on; beside the same valve without the block. {repaired}.
`lm.solve` says to switch the block off before the valve comes back from a service.
"""
PROMISES = """\
## Promises

The error ratio that the study of `lm.solve` foretold, beside that measured here.
"""
CYCLES = """\
Limit cycles: without noise, at three constant loads, after a move of the set point that is taken back; the amplitude
is half of what PV still swings after 2000 rows. A cycle counts above 2 deviations of the noise of PV; the block begins
it or makes it larger where it is also more than 1.1 times that without the block.
"""
BAD = """\
## Single bad cases

Blocks that make the error worse by more than 5 % (at 1, 0.8 or 1.2 of the size), begin a limit cycle, do otherwise than
was foretold by more than 1.5 times, or were made for no fault or another kind. S: size of the lost motion, J: jump.
"""
MISSED = """\
## Faulty loops without a block

By the gate at which the way ended, with the first of its words. The last column counts those in which a block made from
the true valve, with the true noise, would cut the error below 0.8.
"""


def quietly_judged(job: tuple[str, int]) -> Judged:
    """A loop, without warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return judged(job)


def page_of(found: Sequence[Judged]) -> str:
    """The page."""
    parts = [
        *(ABOUT.format(loops=len(found)), WAYS, *page.ways(found)),
        *(GAINS, *page.gains(found)),
        *(OTHERS.format(repaired=page.repaired_harm(found)), *page.other_valves(found)),
        *(PROMISES, *page.promises(found), CYCLES, *page.cycles(found)),
        *(BAD, *page.bad_cases(found)),
        *(MISSED, *page.missed(found)),
    ]
    return "\n".join(parts).rstrip()


def main() -> None:
    """Try the blocks and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", default=",".join(KINDS), metavar="A,B", help="of valves; all unless given")
    parser.add_argument("--loops", type=int, help="of each kind; 6 to 20 unless given")
    parser.add_argument("--first", type=int, default=FIRST, metavar="SEED", help=f"of each kind; {FIRST} unless given")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    kinds = list(dict.fromkeys(given.kinds.split(",")))
    if unknown := [kind for kind in kinds if kind not in KINDS]:
        parser.error(f"expected kinds of valves, got {', '.join(unknown)}; there are {', '.join(KINDS)}")
    if (given.loops is not None and given.loops < 1) or given.first < 0:
        parser.error(f"expected at least one loop and a seed from 0 on, got {given.loops} and {given.first}")
    jobs = [(kind, given.first + k) for kind in kinds for k in range(given.loops or LOOPS[kind])]
    said = page_of(run_all(quietly_judged, jobs, "loops", given.workers, told))
    if kinds == list(KINDS) and given.loops is None and given.first == FIRST:
        publish(OUTPUT, said + "\n")
    else:
        print(said)


if __name__ == "__main__":
    main()
