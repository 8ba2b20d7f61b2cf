"""Verdicts of the diagnosis on loops after twenty-odd published papers on stiction and backlash.

Run: ``.venv/bin/python benchmarks/published.py`` (about 15 minutes on two cores); writes docs/published-loops.md: 463
loops, 103 of them with sound valves, from a simulation that shares nothing with the package. It can be stopped and
goes on where it was. ``--only NAME``: loops whose name begins so, as "kano04-flow" or "he07-lag:he-5-2"; ``--every N``:
each Nth of them; ``--workers N``. Others than all are printed, not written.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import argparse  # noqa: E402
import warnings  # noqa: E402
from collections.abc import Sequence  # noqa: E402
from dataclasses import asdict  # noqa: E402
from pathlib import Path  # noqa: E402
from typing import Any  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate.workers import run_all  # noqa: E402
from pages import kept, publish  # noqa: E402
from pages.written import told  # noqa: E402
from published_loops import page  # noqa: E402
from published_loops.judge import Judged, judged  # noqa: E402
from published_loops.loops import cases, published_loop  # noqa: E402
from published_loops.papers import references  # noqa: E402

OUTPUT = Path(__file__).resolve().parent.parent / "docs" / "published-loops.md"
MOST_WORST = 40

ABOUT = """\
# Loops of published papers

Made by `.venv/bin/python benchmarks/published.py`. {loops} simulated loops: processes, PI controllers and valves after
papers on stiction and backlash, written from memory without knowledge of the simulators of this project, so most
parameters are in a paper's range and not its own to the digit (`benchmarks/published_loops/plants.py`); more loads, set
points and noise than the papers have. A paper's name stands for its loop, not for its result. OP, PV and set point of
1500 to 3000 rows are given to `lm.diagnose`, and nothing else. No weight was fitted on these loops; some rules of
[diagnosis.md](diagnosis.md) were made because of them, so they are no longer unseen.

Noise is 0.3 % of the swing of PV where no other figure is named. The true size is how far the command turns between the
last move of the stem one way and its first move back: that of the parameters where no turn of the simulated stem speaks
against it, otherwise as measured from it, behind the lag of the actuator. A record cannot tell a fault where the stem
never turns in it, where OP never crosses the dead zone, or where OP moves by no more than the fault; these are in no
count but that of their own. One turn is enough to be counted.
"""
FAULTY = """\
## Valves with a fault

Named as a fault: any lost motion, or "saturation". Sizes and intervals are those of any lost motion named; sizes are
given in % of OP, intervals are of 95 %.
"""
SOUND = """\
## Valves without a fault

Cleared: no lost motion that matters is left open. "saturation" is no accusation where OP stands at an end of its range
in a tenth of the rows.
"""
CLAIMS = """\
## Claims

Verdicts but "cannot tell", by the probability claimed that there is a fault of the valve, or none.
"""
WORST = """\
## Worst cases

Faults cleared, sound valves accused, true sizes excluded, faults called sound, a wrong kind, sizes that are off or
outside their interval. `--only NAME` makes one of them again; `published_loops.loops.published_loop(NAME)` has its
record, with the stem.
"""
LOOKED_AT = """\
## Worst cases, looked at

<!-- words by hand -->
"""
NOT_TOLD = """\
## What the record cannot tell
"""
PAPERS = """\
## Papers

Those of the plants, and of the models of valves and friction.
"""


def diagnosed(name: str) -> Judged:
    """Simulate, diagnose and judge a loop, or take what the same source has said of it before."""
    fields = kept("published-loops", name, lambda: asdict(_diagnosed(name)))
    return Judged(**fields | {"interval": tuple(fields["interval"])})


def _diagnosed(name: str) -> Judged:
    loop = published_loop(name)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return judged(loop, lm.diagnose(loop.record))
    except lm.InputError:
        return judged(loop, None)


def page_of(found: Sequence[Judged]) -> str:
    """The page."""
    parts = [
        *(ABOUT.format(loops=len(found)), *page.summary(found), FAULTY),
        *page.faulty(found, "model of the valve", lambda one: page.MODELS[one.model]),
        *page.faulty(found, "loop of", lambda one: one.paper),
        *page.faulty(found, "load, set point and noise", lambda one: one.course),
        *(SOUND, *page.sound(found), CLAIMS, *page.claims(found)),
        *(WORST, *page.worst(found, MOST_WORST), LOOKED_AT, NOT_TOLD, *page.not_told(found)),
        *(PAPERS, *references()),
    ]
    return "\n".join(parts).rstrip()


def main() -> None:
    """Diagnose and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", metavar="NAME", help="loops whose name begins so")
    parser.add_argument("--every", type=int, default=1, metavar="N", help="each Nth of them")
    parser.add_argument("--workers", type=int, default=2)
    given: Any = parser.parse_args()
    if given.every < 1:
        parser.error(f"expected 1 or more, got {given.every}")
    names = [name for name in cases() if name.startswith(given.only)][:: given.every]
    if not names:
        plants = ", ".join(dict.fromkeys(name.split(":")[0] for name in cases()))
        parser.error(f"expected the beginning of a name, got {given.only!r}; plants: {plants}")
    kept("published-loops", "begun", lambda: True)  # parts of another source go before workers make new ones
    said = page_of(run_all(diagnosed, names, "loops", given.workers, told))
    if names == list(cases()):
        publish(OUTPUT, said + "\n")
    else:
        print(said)


if __name__ == "__main__":
    main()
