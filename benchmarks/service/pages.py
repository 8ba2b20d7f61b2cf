"""The page that benchmarks/endurance.py writes."""

from __future__ import annotations

from typing import Any

import numpy as np

from service import days
from service.ledger import AFTER, SIDES, TIMES, Ledger


def page(samples: int, seed: int, lanes: list[Any], memory: list[int]) -> str:
    """All that was found, as a table with a column for each lane."""
    columns = [column(lane.ledger, lane.seconds, samples) for lane in lanes]
    rows = ["| " + " | ".join([name, *(values[name] for values in columns)]) + " |" for name in columns[0]]
    return PAGE.format(
        rows="\n".join(rows), seed=seed, after=AFTER, samples=samples, days=samples / days.DAY,
        head=" | ".join(lane.title for lane in lanes), lines="---|" * len(lanes),
        growth=(memory[1] - memory[0]) / 2**20, first=2 * 10 * 100_000,
    )  # fmt: skip


def column(ledger: Ledger, seconds: float, samples: int) -> dict[str, str]:
    """Figures of one lane by name."""
    values = {
        "checks passed: finite, A stable, break points inside the range of OP": f"{ledger.checks:,}",
        "saved, restored, continued: bit-identical": f"{ledger.restarts} of {ledger.restarts}",
        "saved state, first and last": f"{ledger.first_size:,} and {ledger.last_size:,} bytes",
    }
    for side in SIDES:
        misses = np.array(ledger.misses[side])
        marks = (np.median(misses), np.quantile(misses, 0.95), misses.max())
        for part in TIMES:
            values[f"95 % interval of {side} covers the truth, {part}"] = coverage(ledger, side, part)
        values[f"error of {side}: median, 95 %, largest"] = " / ".join(f"{value:.3f}" for value in marks)
    return values | events(ledger, samples) | {"processor time a sample": f"{1e9 * seconds / samples:.0f} ns"}


def coverage(ledger: Ledger, side: str, part: str) -> str:
    """Share of the checks in a part of the time."""
    told = ledger.told[part]
    return f"{100 * ledger.covered[part, side] / told:.1f} % of {told:,}" if told else "-"


def events(ledger: Ledger, samples: int) -> dict[str, str]:
    """Repairs noticed and false events."""
    rows = {}
    for side in SIDES:
        delays = ledger.delays(side)
        middle = f", after {np.median(delays):,.0f} samples (median)" if delays else ""
        rows[f"repairs noticed at {side}"] = f"{len(delays)} of {len(ledger.repairs)}{middle}"
    for cause, title in (("stuck", "events after PV got stuck"), ("nothing", "events without a cause")):
        names = [event.name for event, why in ledger.events if why == cause]
        kinds = ", ".join(f"{names.count(name)} {name}" for name in sorted(set(names)))
        rows[title] = f"{len(names)} ({kinds}), one in {samples / len(names):,.0f} samples" if names else "0"
    return rows


PAGE = """# Endurance of RecursiveML

Made by `.venv/bin/python benchmarks/endurance.py` (seed {seed}). Paper's level tank in a PI loop as it runs every day:
set-point moves of 1 % in the 8 working hours of a day and none at night, a drifting disturbance all the time, a dead
zone that grows from -1 .. 1 to -1.4 .. 1.6 in working hours and is repaired every 6 days, OP held by hand for some
minutes (no excitation), valve moved by hand with a stale OP (masked), gaps in OP and PV or PV alone, spikes of 17
noise deviations in 1 of 10,000 samples, PV stuck for 3 s on average once in 100,000 samples. Forgetting 0.9995, orders
given, the rest default.

{samples:,} samples, {days:.0f} days of service. The same record goes to two estimators: one gets it as it is and
leaves out by itself a PV that comes again to the last bit more often than chance allows; one is told (`use`) to leave
out every PV that is to the last bit the one before.

| what | {head} |
|---|{lines}
{rows}

Resident memory of the process grew by {growth:.1f} MiB after the first {first:,} samples; the saved state by its
events, 100 at most.

An estimate is checked every 10,000 samples; the run stops at the first that fails. Errors are in the units of OP and
leave out the {after:,} samples after each repair, within which its event is expected. At night OP stays on one side or
in the middle: the other side tells nothing, and its estimate of the evening is counted again at every check.
"""
