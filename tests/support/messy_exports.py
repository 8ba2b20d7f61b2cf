"""Twelve exports as the tools of vendors write them, each of a simulated loop whose truth is known."""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Any

import numpy as np

import lostmotion as lm
import sample_loops
from lostmotion.diagnose.severity import severity_of
from tests.support.packed_files import workbook

START = datetime(2026, 2, 27, 14, 30)
FLOW, LEVEL, TEMPERATURE, TIGHT = (
    next(loop for loop in sample_loops.LOOPS if loop.tag == tag) for tag in ("FIC-101", "LIC-301", "TIC-201", "FIC-103")
)
MOVES = (42.0, 45.0, 40.0, 44.0, 41.0, 46.0, 42.0)


@dataclass(frozen=True)
class Export:
    """Content of a file, and what is true of its loop.

    Attributes
    ----------
    name, content : str and bytes
    verdict : str
        That is right.
    size : float
        Of the lost motion, in units of OP of the file; 0: none.
    span : tuple of float
        Of OP, in units of OP of the file.
    """

    name: str
    content: bytes
    verdict: str
    size: float = 0.0
    span: tuple[float, float] = (0.0, 100.0)

    @property
    def severity(self) -> str:
        """What the true size deserves."""
        return severity_of(100.0 * self.size / (self.span[1] - self.span[0])) if self.size else "none"


def loop(like: sample_loops.Loop, actuator: Any = None, size: float = 0.0, **changes: Any) -> sample_loops.Loop:
    """A sample loop with another valve, or moved otherwise."""
    if actuator is not None:
        changes |= {"actuator": actuator, "size": size, "verdict": actuator.kind}
    return replace(like, **changes)


def signals(one: sample_loops.Loop) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """OP, PV and SP."""
    columns = sample_loops.simulated(one)
    op, pv, sp = (columns[f"{one.tag}.{role}"] for role in ("OP", "PV", "SP"))
    return op, pv, sp


def stamps(n: int, dt: float, form: str) -> list[str]:
    """Times as they are written."""
    return [(START + timedelta(seconds=k * dt)).strftime(form) for k in range(n)]


def table(heads: list[list[str]], *columns: Any, separator: str = ",") -> str:
    """Text with rows of head above the rows."""
    rows = (separator.join(map(str, row)) for row in zip(*columns, strict=True))
    return "\n".join([*(separator.join(head) for head in heads), *rows, ""])


def fixed(values: np.ndarray, digits: int = 2) -> list[str]:
    """Numbers with as many decimals; nothing for a NaN."""
    return [f"{value:.{digits}f}" if np.isfinite(value) else "" for value in values]


def german() -> Export:
    """Excel in German, saved as CSV: semicolon, decimal comma, day first, Windows line ends and code page."""
    one = loop(FLOW, lm.DeadZone(-1.5, 1.5), 3.0, moves=MOVES)
    op, pv, sp = ([text.replace(".", ",") for text in fixed(signal)] for signal in signals(one))
    times = stamps(len(op), 1.0, "%d.%m.%Y %H:%M:%S")
    head = ["Datum/Zeit", "Sollwert [m³/h]", "Istwert [m³/h]", "Regler Ausgang [%]", "Betriebsart"]
    text = table([head], times, sp, pv, op, ["Automatik"] * len(op), separator=";")
    return Export("Export FIC101.csv", text.replace("\n", "\r\n").encode("cp1252"), "dead zone", one.size)


def excel() -> Export:
    """A workbook with three lines of title, and a serial number for the date."""
    op, pv, sp = signals(FLOW)
    first = (START - datetime(1899, 12, 30)) / timedelta(days=1)
    title = [["Trend report Unit 200"], ["Created by: J. Smith"], ["Period: last shift"], []]
    rows = [[first + k / 86400.0, *map(float, values)] for k, values in enumerate(zip(sp, pv, op, strict=True))]
    return Export("FIC-101 trend.xlsx", workbook([*title, ["Time", "SP", "PV", "OP"], *rows]), "stiction", 3.0)


def deltav() -> Export:
    """DeltaV, wide: a row of paths, a row of units."""
    one = loop(FLOW, lm.Backlash(2.5), 2.5, moves=MOVES)
    op, pv, sp = signals(one)
    paths = [f"FIC-101/PID1/{end}.CV" for end in ("SP", "PV", "OUT")]
    heads = [["Date/Time", *paths, "FIC-101/PID1/MODE.ACTUAL"], ["", "m3/h", "m3/h", "%", ""]]
    text = table(heads, stamps(len(op), 1.0, "%m/%d/%Y %H:%M:%S"), *map(fixed, (sp, pv, op)), ["AUTO"] * len(op))
    return Export("DeltaV_history.csv", text.encode(), "backlash", one.size)


def pi_long() -> Export:
    """PI, long: a row for each value of each tag, with its status; bad values hold a word."""
    one = loop(FLOW, lm.Stiction(3.0, 2.0), 3.0, seed=11)
    op, pv, sp = signals(one)
    times = stamps(len(op), 1.0, "%d-%b-%y %H:%M:%S")
    bad = set(range(600, 640)) | set(np.random.default_rng(3).integers(0, len(op), 30).tolist())
    rows = []
    for tag, values in (("SP", sp), ("PV", pv), ("OP", op)):
        for k, value in enumerate(fixed(values)):
            is_bad = tag == "PV" and k in bad
            rows.append((f"FIC101.{tag}", times[k], "Bad Input" if is_bad else value, "Bad" if is_bad else "Good"))
    text = table([["Tag", "Timestamp", "Value", "Status"]], *zip(*rows, strict=True))
    return Export("pi_export.csv", text.encode(), "stiction", one.size)


def milliampere() -> Export:
    """OP in mA, with a true dead band of 3 % of 4..20."""
    one = loop(FLOW, lm.DeadZone(-1.5, 1.5), 3.0, moves=MOVES, seed=7)
    op, pv, sp = signals(one)
    text = table(
        [["Timestamp", "SP", "PV", "OP_mA"]], stamps(len(op), 1.0, "%Y-%m-%d %H:%M:%S"), fixed(sp), fixed(pv),
        fixed(4.0 + 0.16 * op, 4),
    )  # fmt: skip
    return Export("FIC101_mA.csv", text.encode(), "dead zone", 0.48, (4.0, 20.0))


def fraction() -> Export:
    """OP in 0..1, without a unit."""
    one = loop(FLOW, lm.Stiction(3.0, 2.0), 3.0, seed=12)
    op, pv, sp = signals(one)
    text = table(
        [["Timestamp", "SP", "PV", "OP"]], stamps(len(op), 1.0, "%Y-%m-%dT%H:%M:%SZ"), fixed(sp), fixed(pv),
        fixed(0.01 * op, 4),
    )  # fmt: skip
    return Export("fic101_normalised.csv", text.encode(), "stiction", 0.03, (0.0, 1.0))


def gaps(seed: int = 8) -> Export:
    """Three gaps, and one cell in fifty missing."""
    one = loop(FLOW, lm.Backlash(3.0), 3.0, moves=MOVES, seed=seed)
    op, pv, sp = (signal.copy() for signal in signals(one))
    n, random = len(op), np.random.default_rng(5)
    for signal in (op, pv, sp):
        signal[random.integers(0, n, n // 50)] = np.nan
    kept = np.ones(n, dtype=bool)
    for first, rows in ((400, 35), (1100, 120), (1500, 12)):
        kept[first : first + rows] = False
    times = np.array(stamps(n, 1.0, "%Y-%m-%d %H:%M:%S"))
    text = table(
        [["Time", "FIC101.SP", "FIC101.PV", "FIC101.OP"]], times[kept], *(fixed(x[kept]) for x in (sp, pv, op))
    )
    return Export("with gaps.csv", text.encode(), "backlash", one.size)


def modes() -> Export:
    """A loop that operators take in manual now and then: OP moves by hand there."""
    n, backlash, random = 2000, 3.0, np.random.default_rng(9)
    sp = np.repeat(random.uniform(38.0, 46.0, 8), n // 8)
    manual = np.zeros(n, dtype=bool)
    for first, last in ((300, 420), (900, 1100), (1700, 1760)):
        manual[first:last] = True
    op, pv = np.full(n, 46.0), np.full(n, sp[0])
    stem, flow = 46.0, sp[0]
    for k in range(1, n):
        flow = 0.78 * flow + 0.22 * (sp[0] + 0.8 * (stem - 46.0))
        pv[k] = flow + random.normal(scale=0.05)
        error, before = sp[k] - pv[k], sp[k - 1] - pv[k - 1]
        by_hand = random.choice([-4.0, 4.0]) if k % 40 == 0 else 0.0
        op[k] = op[k - 1] + (by_hand if manual[k] else 0.35 * (error - before) + 0.07 * error)
        stem = float(np.clip(stem, op[k] - 0.5 * backlash, op[k] + 0.5 * backlash))
    text = table(
        [["Time", "SP", "PV", "OP", "Mode"]], stamps(n, 1.0, "%Y-%m-%d %H:%M:%S"), *map(fixed, (sp, pv, op)),
        np.where(manual, "MAN", "AUTO").tolist(),
    )  # fmt: skip
    return Export("FIC101_modes.csv", text.encode(), "backlash", backlash)


def newest_first() -> Export:
    """The newest row above, the date and the clock in two columns."""
    one = loop(TEMPERATURE)
    op, pv, sp = signals(one)
    columns = [stamps(len(op), one.dt, "%Y-%m-%d"), stamps(len(op), one.dt, "%H:%M:%S"), *map(fixed, (sp, pv, op))]
    text = table([["Date", "Time", "TIC201.SP", "TIC201.PV", "TIC201.OP"]], *(column[::-1] for column in columns))
    return Export("TIC201 newest first.csv", text.encode(), "dead zone", one.size)


def level() -> Export:
    """A level, which integrates, behind a worn linkage; tabs between the columns."""
    op, pv, sp = signals(LEVEL)
    heads = [["Timestamp", "LIC301.SP [%]", "LIC301.PV [%]", "LIC301.OUT [%]"]]
    text = table(heads, stamps(len(op), LEVEL.dt, "%Y/%m/%d %H:%M:%S"), *map(fixed, (sp, pv, op)), separator="\t")
    return Export("LIC301.txt", text.encode("utf-16"), "backlash", LEVEL.size)


def tight() -> Export:
    """A sound valve in a loop near its limit of stability."""
    op, pv, sp = signals(TIGHT)
    heads = [["Time", "FIC103.SP", "FIC103.PV", "FIC103.OP"]]
    text = table(heads, stamps(len(op), 1.0, "%Y-%m-%d %H:%M:%S.000"), *map(fixed, (sp, pv, op)))
    return Export("FIC103.csv", text.encode(), "other oscillation")


def one_minute() -> Export:
    """A slow temperature in a historian: by exception, read back every minute by interpolation."""
    one = loop(TEMPERATURE, lag=600.0, dead_time=120.0, ti=600.0, dt=60.0, seed=13)
    op, pv, sp = (by_exception(signal, 0.1) for signal in signals(one))
    text = table([["Time", "SP", "PV", "OP"]], stamps(len(op), 60.0, "%Y-%m-%d %H:%M"), *map(fixed, (sp, pv, op)))
    return Export("TIC201_1min.csv", text.encode(), "dead zone", one.size)


def by_exception(signal: np.ndarray, band: float) -> np.ndarray:
    """Values that left a band about the last kept one, straight lines between them."""
    kept = [0]
    for k, value in enumerate(signal):
        if abs(value - signal[kept[-1]]) > band:
            kept += [k - 1, k] if kept[-1] < k - 1 else [k]
    kept.append(len(signal) - 1)
    return np.interp(np.arange(len(signal)), kept, signal[kept])


def manual_test(start: float, steps: tuple[float, ...], hold: int, backlash: float) -> bytes:
    """Record of a test in manual on the flow loop: each step up, back, down, back."""
    random = np.random.default_rng(1)
    each = [np.repeat([step, 0.0, -step, 0.0], hold) for step in steps]
    op = start + np.concatenate([np.zeros(20), *each])
    stem, flow, pv = start + 0.2, 42.0, np.zeros(op.size)
    for k, command in enumerate(op):
        stem = float(np.clip(stem, command - 0.5 * backlash, command + 0.5 * backlash))
        flow = 0.78 * flow + 0.22 * (42.0 + 0.8 * (stem - start))
        pv[k] = flow + random.normal(scale=0.05)
    times = stamps(op.size, 1.0, "%Y-%m-%d %H:%M:%S")
    return table([["Time", "PV", "OP", "Mode"]], times, fixed(pv), fixed(op), ["MAN"] * op.size).encode()


EXPORTS = {
    make.__name__: make
    for make in (
        german, excel, deltav, pi_long, milliampere, fraction, gaps, modes, newest_first, level, tight, one_minute,
    )
}  # fmt: skip
