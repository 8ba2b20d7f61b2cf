"""Writes the tallies of docs/security.md from the log that the attacks keep: nobody copies figures by hand.

Run: ``PYTHONPATH=.:benchmarks .venv/bin/python benchmarks/hostile_page.py LOG``. Of each format or attack the run with
the source of now stands first; what was tried on other sources stands beside it as earlier. Only what lies between the
two marks of the page is replaced.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks.pages.publish import replace_text

import hostile_log
import hostile_readers

PAGE = Path(__file__).resolve().parents[1] / "docs" / "security.md"
BEGIN, END = "<!-- tallies, by benchmarks/hostile_page.py -->\n", "<!-- end of the tallies -->\n"
MOST = 12  # outcomes of an attack in one cell


@dataclass
class Tried:
    """What was tried of one part, on the source of now and on others."""

    now: Counter[str] = field(default_factory=Counter)
    earlier: Counter[str] = field(default_factory=Counter)
    seconds: float = 0.0


def tried(log: hostile_log.Log, attack: str) -> dict[str, Tried]:
    """By part, in the order of the log."""
    found: dict[str, Tried] = {}
    for entry in log.entries():
        if entry.attack == attack:
            one = found.setdefault(entry.part, Tried())
            here = entry.source == hostile_log.source(attack)
            (one.now if here else one.earlier).update(entry.tally)
            one.seconds += entry.seconds * here
    return found


def of_readers(log: hostile_log.Log) -> Iterator[str]:
    """Table of the formats."""
    yield "| file | tried | read, refused in one line | ended the process of its reader | anything else | earlier |"
    yield "|---|---|---|---|---|---|"
    found = {attack: tried(log, attack) for attack in (hostile_readers.ATTACK, hostile_readers.BESIDE)}
    for kind in hostile_readers.EVERY:
        one = found[hostile_readers.attack_of(kind)].get(kind, Tried())
        now, before = (hostile_readers.sorted_out(tally) for tally in (one.now, one.earlier))
        earlier = f"{before.tried:,}: {before.worse}" if before.tried else ""
        told = f"{now.read:,}, {now.refused:,}" if now.tried else ""
        cells = (kind, f"{now.tried:,}", told, now.died or "", now.worse if now.tried else "", earlier)
        yield f"| {' | '.join(map(str, cells))} |"


def of_others(log: hostile_log.Log) -> Iterator[str]:
    """Table of the other attacks: every outcome with its number."""
    yield "| attack | outcomes on this source | earlier |"
    yield "|---|---|---|"
    for name, one in tried(log, hostile_log.OTHERS).items():
        yield f"| {name} | {_outcomes(one.now)} | {_outcomes(one.earlier)} |"


def _outcomes(tally: Counter[str]) -> str:
    said = [f"{times:,} x {outcome}".replace("|", "/") for outcome, times in sorted((+tally).items())]
    return "; ".join([*said[:MOST], *([f"and {len(said) - MOST} more outcomes"] if len(said) > MOST else [])]) or "none"


def main() -> int:
    """Write the page."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("log", type=Path)
    log = hostile_log.Log(options.parse_args().log)
    text = PAGE.read_text(encoding="utf-8")
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    if not after:
        raise SystemExit(f"expected the marks {BEGIN!r} and {END!r} in {PAGE}")
    said = "\n".join([*of_readers(log), "", *of_others(log)])
    replace_text(PAGE, f"{before}{BEGIN}\n{said}\n\n{END}{after}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
