"""The page that benchmarks/endurance.py writes."""

from __future__ import annotations

import numpy as np

from service import days
from service.ledger import AFTER, SIDES, TIMES, Ledger


def page(samples: int, seed: int, ledger: Ledger, seconds: float, memory: list[int]) -> str:
    """All that was found, as a table."""
    rows = [
        ("samples, days of service", f"{samples:,}, {samples / days.DAY:.0f}"),
        ("checks passed: finite, A stable, break points inside the range of OP", f"{ledger.checks:,}"),
        ("saved, restored, continued: bit-identical", f"{ledger.restarts} of {ledger.restarts}"),
        ("saved state, first and last", f"{ledger.first_size:,} and {ledger.last_size:,} bytes"),
        (
            "memory of the process: growth after 2,000,000 samples",
            f"{(memory[1] - memory[0]) / 2**20:.1f} MiB",
        ),
    ]
    for side in SIDES:
        misses = np.array(ledger.misses[side])
        rows += [
            (f"95 % interval of {side} covers the truth", coverage(ledger, side)),
            (
                f"error of {side}: median, 95 %, largest",
                " / ".join(f"{value:.3f}" for value in (np.median(misses), np.quantile(misses, 0.95), misses.max())),
            ),
        ]
    rows += event_rows(ledger, samples)
    rows.append(("processor time of RecursiveML a sample", f"{1e9 * seconds / samples:.0f} ns"))
    return PAGE.format(rows="\n".join(f"| {name} | {value} |" for name, value in rows), seed=seed, after=AFTER)


def coverage(ledger: Ledger, side: str) -> str:
    """Share of the checks by part of the day."""
    parts = [part for part in TIMES if ledger.told[part]]
    return ", ".join(f"{100 * ledger.covered[part, side] / ledger.told[part]:.1f} % ({part})" for part in parts)


def event_rows(ledger: Ledger, samples: int) -> list[tuple[str, str]]:
    """Repairs found and false events."""
    rows = []
    for side in SIDES:
        delays = ledger.delays(side)
        middle = f", after {np.median(delays):,.0f} samples (median)" if delays else ""
        rows.append((f"repairs noticed at {side}", f"{len(delays)} of {len(ledger.repairs)}{middle}"))
    for cause, title in (("stuck", "events after PV got stuck"), ("nothing", "events without a cause")):
        names = [event.name for event, why in ledger.events if why == cause]
        kinds = ", ".join(f"{names.count(name)} {name}" for name in sorted(set(names)))
        rows.append((title, f"{len(names)} ({kinds}), one in {samples / len(names):,.0f} samples" if names else "0"))
    return rows


PAGE = """# Endurance of RecursiveML

Made by `.venv/bin/python benchmarks/endurance.py` (seed {seed}). Paper's level tank in a PI loop as it runs every day:
set-point moves of 1 % in the 8 working hours of a day and none at night, a drifting disturbance all the time, a dead
zone that grows from -1 .. 1 to -1.4 .. 1.6 in working hours and is repaired every 6 days, OP held by hand for some
minutes (no excitation), valve moved by hand with a stale OP (masked), gaps in OP and PV or PV alone, spikes of 17
noise deviations in 1 of 10,000 samples, PV stuck for 3 s on average once in 100,000 samples. Forgetting 0.9995, orders
given, the rest default.

| what | found |
|---|---|
{rows}

An estimate is checked every 10,000 samples; the run stops at the first that fails. Errors are in the units of OP and
leave out the {after:,} samples after each repair, within which its event is expected. At night OP stays on one side or
in the middle: the other side tells nothing, and its estimate of the evening is counted again at every check. A PV
that stops while OP moves is no noise, and nothing in the estimator knows of it: mask it (`use`) where the record tells.
"""
