"""Bias of the width by how a record was stored: the same loop, stored whole and as historians store it; a table.

python benchmarks/resampling.py --seeds 40 --rows 2000 --out resampling.md

Each difference is one between two fits of the same loop, in standard errors of the fit of the stored record, so that
what the estimator itself is off by drops out. A record counts as warned of where `lostmotion check` says more of it
than of the whole one: that values were made up, averaged or seldom stored, or that it is not to be used.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import polars as pl

import lostmotion as lm
from historian import by_exception, by_swinging_door
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import InputError
from lostmotion.records.checked import CheckedRecord

SCAN = 12.0  # s
LAG, DEAD_TIME = 6.0, 0.5  # samples
BREAK = 1.0  # of the dead zone, to either side
KP, KI = 0.5, 0.06  # of the controller, per sample
NOISE = 0.3
ORDERS = (1, 2, 1)
BAR = 0.5  # standard errors


@dataclass(frozen=True)
class Loop:
    """What the controller saw and did: moments in scans, OP, PV and SP; shape (n,)."""

    time: FloatArray
    op: FloatArray
    pv: FloatArray
    sp: FloatArray


def simulated(seed: int, steps: FloatArray, scans: int = 1, typed: bool = False) -> Loop:
    """Dead zone, lag and dead time under PI control, set point in steps.

    Parameters
    ----------
    steps : ndarray, shape (n,)
        Lengths of the controller's scans, in samples of the record.
    scans : int
        Of the controller in one sample of the record.
    typed : bool
        The set point is typed, in tenths, at any scan; else it moves with a sample.
    """
    rng = np.random.default_rng([seed, 18])
    n, held = len(steps), 60 * scans
    noise = NOISE * rng.normal(size=n)
    levels = rng.uniform(-4.0, 4.0, size=n // held + 1)
    moves = held * np.arange(1, len(levels))
    if typed:
        levels, moves = np.round(levels, 1), moves + rng.integers(scans, size=len(moves))
    wanted = levels[np.searchsorted(moves, np.arange(n), side="right")]
    op, pv, late = np.zeros(n), np.zeros(n), int(DEAD_TIME * scans)
    rest = DEAD_TIME - late / scans
    x = integral = 0.0
    for k in range(n):
        pv[k] = x + noise[k]
        error = wanted[k] - pv[k]
        integral += KI * error * steps[k]
        op[k] = KP * error + integral
        for moved, length in ((op[max(k - late - 1, 0)], rest), (op[max(k - late, 0)], steps[k] - rest)):
            through = moved - np.sign(moved) * min(abs(moved), BREAK)
            x = through + (x - through) * np.exp(-length / LAG)
    return Loop(np.cumsum(np.r_[0.0, steps[:-1]]), op, pv, wanted)


def noise_of(values: FloatArray) -> float:
    """Deviation that is told from second differences."""
    return float(np.std(np.diff(values, 2)) / np.sqrt(6.0))


def export(times: FloatArray, op: FloatArray, pv: FloatArray, ops: IntArray, pvs: IntArray) -> pl.DataFrame:
    """Rows in which one of them was stored."""
    rows = np.union1d(ops, pvs)
    cells = {name: np.where(np.isin(rows, at), values[rows], np.nan) for name, values, at in (
        ("OP", op, ops), ("PV", pv, pvs))}  # fmt: skip
    return pl.DataFrame({"t_s": np.round(times[rows] * SCAN, 3), **cells}).fill_nan(None)


Stored = tuple[lm.LoopRecord, lm.LoopRecord]  # whole, and as it was stored


def compressed(keep: Callable[[FloatArray, float], IntArray], seed: int, rows: int, deviation: float) -> Stored:
    """Each tag stored with a deviation in units of its own noise."""
    loop = simulated(seed, np.ones(rows))
    at = [keep(values, deviation * noise_of(values)) for values in (loop.op, loop.pv)]
    return whole(loop), lm.read_loop(export(loop.time, loop.op, loop.pv, at[0], at[1]), dt=SCAN)


def jittered(seed: int, rows: int, deviation: float) -> Stored:
    """Scans of uneven length, by their deviation in scans."""
    rng = np.random.default_rng([seed, 19])
    shape = 0.2 / deviation**2
    steps = np.clip(1.0 + deviation * (rng.gamma(shape, size=rows) - shape) / np.sqrt(shape), DEAD_TIME + 0.05, None)
    loop = simulated(seed, np.round(steps * SCAN) / SCAN)
    frame = pl.DataFrame({"t_s": np.round(loop.time * SCAN), "OP": loop.op, "PV": loop.pv})
    return whole(simulated(seed, np.ones(rows))), read(frame)


def read(frame: pl.DataFrame) -> lm.LoopRecord:
    """Record of an export; where it is refused with a way on, by that."""
    try:
        return lm.read_loop(frame)
    except InputError as error:
        if not error.ways:
            raise
        return lm.read_loop(frame, **dict(error.ways[0]))


def averaged(seed: int, rows: int, scans: float, with_sp: bool = False) -> Stored:
    """Means of OP and PV, and of SP, over some scans, with the stamp of the first; whole: one scan of each."""
    many = int(scans)
    loop = simulated(seed, np.full(rows * many, 1.0 / many), many, typed=with_sp)
    op, pv, sp = (values.reshape(rows, many).mean(axis=1) for values in (loop.op, loop.pv, loop.sp))
    frame = pl.DataFrame({"t_s": loop.time[::many] * SCAN, "OP": op, "PV": pv} | ({"SP": sp} if with_sp else {}))
    return whole(loop, many), lm.read_loop(frame)


def in_turn(seed: int, rows: int, scans: float) -> Stored:
    """A tag is stored every so many scans, OP half of that before PV; whole: both in the scans of PV."""
    many = int(scans)
    loop = simulated(seed, np.full(rows * many, 1.0 / many), many)
    every = np.arange(0, rows * many, many)
    frame = export(loop.time, loop.op, loop.pv, every, every[:-1] + (many + 1) // 2)
    return whole(loop, many, (many + 1) // 2), lm.read_loop(frame)


def whole(loop: Loop, every: int = 1, first: int = 0) -> lm.LoopRecord:
    """The record without a loss."""
    return lm.LoopRecord(loop.op[first::every], loop.pv[first::every], dt=SCAN)


KINDS: dict[str, tuple[Callable[[int, int, float], Stored], tuple[float, float, float], str]] = {
    "swinging door": (lambda *case: compressed(by_swinging_door, *case), (0.2, 0.7, 2.0), "deviations of the noise"),
    "dead band": (lambda *case: compressed(by_exception, *case), (0.2, 0.7, 2.0), "deviations of the noise"),
    "jitter of the scan": (jittered, (0.1, 0.2, 0.3), "scans"),
    "averages": (averaged, (2.0, 4.0, 8.0), "scans"),
    "averages, with SP": (lambda *case: averaged(*case, with_sp=True), (2.0, 4.0, 8.0), "scans"),
    "tags in turn": (in_turn, (2.0, 4.0, 8.0), "scans"),
}


@dataclass
class Tally:
    """Outcomes of one kind and deviation."""

    tried: int = 0
    off: list[float] = field(default_factory=list)
    silent: list[float] = field(default_factory=list)
    warned: int = 0
    refused: int = 0

    def note(self, seed: int, rows: int, kind: str, deviation: float) -> None:
        """Fit one pair."""
        self.tried += 1
        try:
            clean, stored = KINDS[kind][0](seed, rows, deviation)
        except InputError:
            self.refused += 1
            return
        more = warnings_of(stored) - warnings_of(clean)
        self.warned += bool(more)
        one, other = (width(record) for record in (clean, stored))
        if one is None or other is None:
            return
        off = (other[0] - (2.0 * BREAK if kind.startswith("averages") else one[0])) / other[1]
        self.off.append(off)
        if not more:
            self.silent.append(off)


def warnings_of(record: lm.LoopRecord) -> set[str]:
    """What a check warns of, without its numbers."""
    found = CheckedRecord.of(record)
    said = [finding.what for finding in found.report.findings if finding.level != "info"]
    said += [note for note in found.prepared.notes if "made up" in note or "intervals" in note]
    said += ["refused"] if not found.usable else []
    return {"".join(sign for sign in one if not sign.isdigit() and sign != ".") for one in said}


def width(record: lm.LoopRecord) -> tuple[float, float] | None:
    """Width and its standard error; None where there is no fit."""
    try:
        fit = lm.identify(record, nonlinearity="dead zone", orders=ORDERS)
    except InputError:
        return None
    size, error = fit.parameters["width"], fit.standard_errors["width"]
    return (size, error) if np.isfinite(size) and np.isfinite(error) and error > 0 else None


def table(tallies: dict[tuple[str, float], Tally]) -> Iterator[str]:
    """Markdown."""
    yield "| stored by | by | refused | warned of | bias, standard errors | where nothing was said |"
    yield "|---|---:|---:|---:|---:|---:|"
    for (kind, deviation), one in tallies.items():
        yield (
            f"| {kind} | {deviation:g} {KINDS[kind][2]} | {one.refused}/{one.tried} | {one.warned}/{one.tried} "
            f"| {shown(one.off)} | {shown(one.silent)} |"
        )


def shown(values: list[float]) -> str:
    """Mean and twice its own standard error, of three at least."""
    if len(values) < 3:
        return "none" if not values else f"{len(values)} only"
    return f"{np.mean(values):+.2f} ± {2 * np.std(values, ddof=1) / np.sqrt(len(values)):.2f} ({len(values)})"


def main() -> None:
    """Print the table, and write it where that is wanted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=40)
    parser.add_argument("--rows", type=int, default=2000)
    parser.add_argument("--kinds", nargs="*", default=list(KINDS), choices=list(KINDS))
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    begun = time.process_time()
    tallies = {(kind, deviation): Tally() for kind in asked.kinds for deviation in KINDS[kind][1]}
    for (kind, deviation), tally in tallies.items():
        for seed in range(asked.seeds):
            tally.note(seed, asked.rows, kind, deviation)
        print(f"{kind} {deviation:g}: {shown(tally.off)}, {shown(tally.silent)}", flush=True)
    lines = "\n".join(table(tallies))
    print(f"{lines}\n\n{asked.seeds} seeds of {asked.rows} rows, {time.process_time() - begun:.0f} s of a processor")
    if asked.out is not None:
        asked.out.write_text(f"{lines}\n", encoding="utf-8")


if __name__ == "__main__":
    main()
