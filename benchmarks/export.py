"""Exported blocks executed by an ST machine and by compiled C, a million scans each, against the simulated block.

Run: ``make plc && .venv/bin/python benchmarks/export.py`` (about 15 minutes); writes docs/export.md.
Options: ``--scans N`` and ``--no-mutants`` for a shorter run, which writes no page. Started again, it goes on
after the last block that was finished.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from lostmotion.export import TARGETS  # noqa: E402
from lostmotion.export.dialects import restore  # noqa: E402
from lostmotion.export.replay import compare, expected  # noqa: E402
from lostmotion.export.scenarios import scenario  # noqa: E402
from pages import kept, publish  # noqa: E402
from tests.plc.machine import DoesNotCompileError, run_in_c, run_in_machine  # noqa: E402
from tests.plc.mutants import mutants  # noqa: E402
from tests.support.exports import KINDS, REALS, source  # noqa: E402

OUTPUT = ROOT / "docs" / "export.md"
TEMPLATE = Path(__file__).parent / "export.md"
SCANS = 1_000_000
PART = 100_000
MUTANT_SCANS = 20_000
FIRST = 100  # stretches: most show at once


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scans", type=int, default=SCANS)
    parser.add_argument("--no-mutants", action="store_true")
    arguments = parser.parse_args()
    agreement, visits = [], []
    for kind in KINDS:
        for real in REALS:
            key = f"{kind} {real} {arguments.scans} scans"
            rows, seen = kept("export", key, lambda k=kind, r=real: execute(k, r, arguments.scans))
            agreement += rows
            visits.append(seen)
            print(*rows, seen, sep="\n", flush=True)
    caught = [] if arguments.no_mutants else [kept("export", f"{k} mutants", lambda k=k: mutate(k)) for k in KINDS]
    if caught and arguments.scans == SCANS:
        tables = {
            "targets": targets(),
            "agreement": table(agreement),
            "visits": table(visits),
            "mutants": table(caught),
        }
        publish(OUTPUT, TEMPLATE.read_text(encoding="utf-8").format(**tables))


def targets() -> str:
    """Rows of what each dialect has gone through."""
    return "\n".join(f"| `{d.name}` | {d.title} | {d.proven} | {d.unproven} |" for d in TARGETS.values())


def execute(kind: str, real: str, scans: int) -> tuple[list[str], str]:
    """Rows of the table of agreement for machine and C, and the row of what the scans visited."""
    one = source(kind, real)
    text, code = restore(TARGETS["st"].files(one)), TARGETS["c"].files(one)
    worst, flags, seconds = Counter(), Counter(), Counter()
    states, total = Counter(), 0
    for seed in range(max(scans // PART, 1)):
        stretches = scenario(one.specification, one.parameters, min(PART, scans), seed)
        kernel = expected(one, stretches)
        total += len(kernel)
        for way in ("ST machine", "C, gcc -O2"):
            start = time.perf_counter()
            if way == "ST machine":
                found = run_in_machine(text, one, stretches)
            else:
                with tempfile.TemporaryDirectory() as folder:
                    found = run_in_c(code, one, stretches, Path(folder))
            seconds[way] += time.perf_counter() - start
            proof = compare(one, kernel, found)
            worst[way] = max(worst[way], proof.worst)
            flags[way] += proof.different_flags
        states += count(one, kernel)
    rows = [
        f"| {kind} | {real.upper()} | {way} | {total:,} | {worst[way]:.2g} | {flags[way]} |"
        for way in ("ST machine", "C, gcc -O2")
    ]
    print({way: f"{1e6 * spent / total:.1f} us a scan" for way, spent in seconds.items()})
    return rows, f"| {kind} | {real.upper()} | " + " | ".join(f"{100 * states[k] / total:.2g}" for k in range(9)) + " |"


def count(one, kernel) -> Counter:
    """Scans in each STATE (0 .. 4), and at the limits, capped, ramping, with refused settings (5 .. 8)."""
    columns = {variable.name: kernel[:, k] for k, variable in enumerate(one.specification.section("output"))}
    result = Counter({state: int((columns["STATE"] == state).sum()) for state in range(5)})
    limited = np.maximum(columns["LIMITED_LOW"], columns["LIMITED_HIGH"])
    for k, flag in enumerate((limited, columns["OFFSET_CAPPED"], columns["RAMPING"], columns["ERROR"]), 5):
        result[k] = int((flag != 0.0).sum())
    return result


def mutate(kind: str) -> str:
    """Row of the table of mutants: how many single wrong tokens the machine's outputs betray."""
    one = source(kind)
    stretches = scenario(one.specification, one.parameters, MUTANT_SCANS)
    kernel = expected(one, stretches)
    made, missed = 0, []
    for what, text in mutants(TARGETS["st"].files(one)["FY_101.st"]):
        made += 1
        if unseen(one, text, stretches[:FIRST], kernel) and unseen(one, text, stretches, kernel):
            missed.append(what)
    print(kind, *missed, sep="\n  ", flush=True)
    sums = [what for what in missed if re.search(r"'(ABS|\+|-)' to .* in total := ", what)]
    edges = [what for what in missed if re.search(r"'[<>]=?' to '[<>]=?'", what)]
    rest = len(missed) - len(sums) - len(edges)
    return f"| {kind} | {made} | {made - len(missed)} | {len(sums)} | {len(edges)} | {rest} |"


def unseen(one, text, stretches, kernel) -> bool:
    """The machine's outputs are the kernel's; not where the text does not compile or stops in a fault."""
    try:
        found = run_in_machine(text, one, stretches)
    except (DoesNotCompileError, AssertionError):
        return False
    return compare(one, kernel[: len(found)], found).agrees


def table(rows: list[str]) -> str:
    return "\n".join(rows)


if __name__ == "__main__":
    main()
