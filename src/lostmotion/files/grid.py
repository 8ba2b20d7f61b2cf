"""Rows with stamps -> samples of a fixed rate: gaps become missing samples, repeated stamps are left out, and told."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.cells import Cells
from lostmotion.files.times import time_text
from lostmotion.kernels.stamps import LAST, RESTART, count_samples
from lostmotion.records.sampling import Bools

LONGEST_GAP = 1000  # samples: after so many missing ones, more tell an estimator nothing
ALWAYS_TOLD = 10  # of each kind of trouble; then the 100th, 1000th ..
KINDS = {
    "garbled": "a cell is neither a number nor a word for a missing value; it counts as missing",
    "untimed": "no time yet from which it could follow; left out",
    "repeated": "its time is not a sample later than that of the row before; left out",
    "long gaps": "a long gap before it; {limit} samples count as missing, the rest of the gap is passed over",
    "restarts": "time does not go on from the row before; taken as a new recording, after {limit} missing samples",
}


@dataclass(frozen=True)
class Note:
    """Something odd in a row: line in the source (from 1), time in seconds, and words."""

    line: int
    time: float
    text: str


@dataclass(frozen=True, eq=False)
class Rows:
    """Samples at the sampling time, in order.

    Attributes
    ----------
    time, op, pv : ndarray, shape (n,)
        Seconds and signals; op and pv are NaN where a sample is missing.
    automatic : ndarray of bool, shape (n,), or None
        The controller moves the valve (True for missing samples); None without a mode column.
    breaks : ndarray of int
        Samples (from 0 in these arrays) whose time does not go on from the sample before.
    notes : tuple of Note
        What was odd.
    inserted : ndarray of bool, shape (n,), or None
        Samples of gaps, for which no row has come; None: there are none.
    """

    time: FloatArray
    op: FloatArray
    pv: FloatArray
    automatic: Bools | None = None
    breaks: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    notes: tuple[Note, ...] = ()
    inserted: Bools | None = None

    @property
    def came(self) -> int:
        """Samples for which a row has come."""
        return len(self) - (0 if self.inserted is None else int(self.inserted.sum()))

    def __len__(self) -> int:
        return self.op.size

    def part(self, first: int, stop: int) -> Rows:
        """Samples from `first` up to `stop`, without the notes."""
        rows = slice(first, stop)
        automatic = None if self.automatic is None else self.automatic[rows]
        breaks = self.breaks[(self.breaks >= first) & (self.breaks < stop)] - first
        inserted = None if self.inserted is None else self.inserted[rows]
        return Rows(self.time[rows], self.op[rows], self.pv[rows], automatic, breaks, inserted=inserted)


class Grid:
    """Clock of a growing record.

    Parameters
    ----------
    dt : float
        Sampling time in seconds.
    timed : bool
        There is a time column; without one the rows are a sampling time apart.
    wrap : float
        Seconds after which times begin anew; 0 for never.
    calendar : str
        See :class:`lostmotion.files.layout.Layout`.
    state : dict, optional
        From :attr:`state`.
    again : bool
        The source may begin again with rows that were taken before: pass over them.
    word : str
        What the rows are called in notes.

    Examples
    --------
    >>> from lostmotion.files.layout import Layout
    >>> from lostmotion.files.cells import read_cells
    >>> layout = Layout("t,OP,PV", ("t", "OP", "PV"), ",", "OP", "PV", "t", None, ".", dt=1.0)
    >>> rows = Grid(1.0).place(read_cells([b"0,1,2", b"1,1,2", b"1,5,5", b"4,1,3"], layout)[0], [2, 3, 4, 5])
    >>> rows.time, rows.pv, rows.notes[0].line
    (array([0., 1., 2., 3., 4.]), array([ 2.,  2., nan, nan,  3.]), 4)
    """

    def __init__(
        self,
        dt: float,
        timed: bool = True,
        wrap: float = 0.0,
        calendar: str = "",
        state: dict[str, Any] | None = None,
        again: bool = False,
        word: str = "Line",
    ) -> None:
        self.word = word
        self.dt, self._timed, self._wrap, self._calendar = dt, timed, wrap, calendar
        stored = state or {}
        self.again = again and timed and not wrap
        clock = stored.get("clock", [None, 0.0, 0.0, 0.0])
        self._clock = np.array([np.nan if value is None else value for value in clock])
        self.counts: dict[str, int] = dict.fromkeys(("rows", "inserted", *KINDS), 0) | stored.get("counts", {})

    @property
    def state(self) -> dict[str, Any]:
        """What the next rows need, JSON-ready."""
        clock = [None if np.isnan(value) else value for value in self._clock.tolist()]
        return {"clock": clock, "counts": dict(self.counts)}

    def restart(self) -> None:
        """The next row begins a new recording, whatever its time."""
        if not np.isnan(self._clock[LAST]):
            self._clock[LAST] = np.inf

    def place(self, cells: Cells, lines: npt.ArrayLike) -> Rows:
        """Put rows on the clock; `lines` are their numbers in the source."""
        times, counts = self._count(cells)
        notes = self._notes(cells, np.asarray(lines, dtype=np.int64), times, counts)
        self.counts["rows"] += len(cells)
        breaks = counts == RESTART
        passed = np.where(breaks, LONGEST_GAP + 1, np.minimum(counts, LONGEST_GAP + 1))
        if cells.moved is not None:
            breaks[cells.moved[0]] = True
        return self._spread(cells, times, passed, breaks, notes)

    def _count(self, cells: Cells) -> tuple[FloatArray, IntArray]:
        n = len(cells)
        if not self._timed:
            times = np.arange(self.counts["rows"], self.counts["rows"] + n, dtype=np.float64)
            return times * self.dt, np.ones(n, dtype=np.int64)
        times, counts = cells.stamps.copy(), np.zeros(n, dtype=np.int64)
        begin = self._first_new(cells.stamps)
        cut, move = (n, 0.0) if cells.moved is None else cells.moved
        cut = max(cut, begin)
        counts[begin:cut] = self._step(cells.stamps[begin:cut], times[begin:cut])
        self._clock[0] += move
        counts[cut:] = self._step(cells.stamps[cut:], times[cut:])
        return times, counts

    def _step(self, stamps: FloatArray, times: FloatArray) -> IntArray:
        counts: IntArray = count_samples(stamps, self.dt, self._wrap, self._clock, times)
        return counts

    def _first_new(self, stamps: FloatArray) -> int:
        """Pass over the rows of a source that was given again from its beginning."""
        if not self.again:
            return 0
        new = np.flatnonzero(stamps + self._clock[2] > self._clock[0])
        self.again = not new.size
        return int(new[0]) if new.size else stamps.size

    def _notes(self, cells: Cells, lines: IntArray, times: FloatArray, counts: IntArray) -> tuple[Note, ...]:
        found = {
            "garbled": cells.garbled,
            "untimed": np.isnan(times),
            "repeated": (counts == 0) & ~np.isnan(times),
            "long gaps": counts > LONGEST_GAP + 1,
            "restarts": counts == RESTART,
        }
        notes = []
        for kind, where in found.items():
            for row in np.flatnonzero(where):
                self.counts[kind] += 1
                if _told(self.counts[kind]):
                    notes.append(self._note(kind, int(lines[row]), float(times[row])))
        return tuple(sorted(notes, key=lambda note: note.line))

    def _note(self, kind: str, line: int, time: float) -> Note:
        text = KINDS[kind].format(limit=LONGEST_GAP)
        number = self.counts[kind]
        many = f" ({number} such rows so far)" if number >= ALWAYS_TOLD else ""
        return Note(line, time, f"{self.word} {line} ({time_text(time, self._calendar)}): {text}{many}.")

    def _spread(
        self, cells: Cells, times: FloatArray, passed: IntArray, breaks: Bools, notes: tuple[Note, ...]
    ) -> Rows:
        """Give each row its missing samples in front."""
        if (passed == 1).all():
            return Rows(times, cells.op, cells.pv, cells.automatic, np.flatnonzero(breaks), notes)
        rows = np.repeat(np.arange(len(cells)), passed)
        ends = np.cumsum(passed) - 1
        real = np.zeros(rows.size, dtype=bool)
        real[ends[passed > 0]] = True
        self.counts["inserted"] += int(rows.size - real.sum())
        automatic = None if cells.automatic is None else cells.automatic[rows] | ~real
        time = times[rows] - (ends[rows] - np.arange(rows.size)) * self.dt
        op, pv = (np.where(real, signal[rows], np.nan) for signal in (cells.op, cells.pv))
        return Rows(time, op, pv, automatic, (ends - passed + 1)[breaks], notes, ~real)


def _told(count: int) -> bool:
    return count <= ALWAYS_TOLD or 10 ** round(np.log10(count)) == count
