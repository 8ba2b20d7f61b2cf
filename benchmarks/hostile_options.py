"""Attack on the command line: every option and argument of every command with extreme values, and records at the edge.

Run: ``PYTHONPATH=.:benchmarks .venv/bin/python benchmarks/hostile_options.py`` (about two hours); ``--share 0.05`` is a
quick look, ``--only options``. Prints a table; exit code 1 where anything but a result or a refusal in one line came
out: no traceback, no warning, nothing of libraries on standard error, 60 s at most. Commands run in this process, with
a limit of memory. `live`, `demo-live`, `serve` and `warm-up` are not among them: they run until they are stopped.
"""

from __future__ import annotations

import argparse
import resource
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hostile_log import Log
from hostile_tally import HEAD, told
from tests.support import extreme_options

MEMORY = 6 << 30  # bytes of address space: what an extreme value asks for is refused, and does not take the computer
Tries = Iterator[Counter[str]]


def attack_options(share: float, random: np.random.Generator) -> Tries:
    """Every parameter with every value, or a share of them."""
    cases = list(extreme_options.cases())
    chosen = random.permutation(len(cases))[: max(1, round(share * len(cases)))]
    with extreme_options.small_folder() as folder:
        for k in chosen:
            name, words = cases[k]
            found = extreme_options.outcome(name, words)
            extreme_options.tidy(folder)
            bad = found[:3].isupper()
            yield Counter({f"{found} by {name} {words!r}"[:300] if bad else found: 1})


ATTACKS = {"options": attack_options}


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--share", type=float, default=1.0, help="of all cases")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", choices=ATTACKS, action="append")
    options.add_argument("--log", type=Path, help="keep what was tried")
    given = options.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    print(HEAD)
    bad = False
    for name in given.only or ATTACKS:
        bad |= told(name, ATTACKS[name](given.share, np.random.default_rng(given.seed)), Log(given.log))
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
