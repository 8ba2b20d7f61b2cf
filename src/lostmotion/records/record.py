"""LoopRecord: the samples of one control loop, and what is known about them."""

from __future__ import annotations

import hashlib
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.arguments import seconds
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.html_table import html_table
from lostmotion.printable import label
from lostmotion.records.span import about_unit
from lostmotion.records.when import as_moment, bound, later, nothing_there

if TYPE_CHECKING:
    from lostmotion.records.checked import CheckedRecord

StringArray = npt.NDArray[np.str_]
LARGEST = 1e30  # of a value, whatever its unit: squares of larger ones, summed, are no numbers any more
MOST_SPAN = 1e6  # times the largest value: a valve that is closed but for noise has a thousandth of its span
_SIGNALS = ("op", "pv", "sp", "position")


@dataclass(frozen=True, eq=False)
class LoopRecord:
    """Samples of one loop on a uniform time grid.

    Parameters
    ----------
    op, pv : array_like, shape (n,)
        Controller output (the command to the actuator) and measurement. NaN marks a missing sample.
    sp, position : array_like, shape (n,), optional
        Set point and measured position of the actuator.
    dt : float
        Sampling time in seconds.
    mode : array_like of str, shape (n,), optional
        Mode of the controller in each row as the plant writes it ("AUTO", "MAN", "CAS" ..); "" where unknown.
    op_span, pv_span : (float, float), optional
        Engineering limits (low, high), for results in % of span. None: unknown; that of OP is then taken from
        `op_unit` where it is the unit of a signal (4 .. 20 for "mA"), which a note reports.
    tag, source : str
        Name of the loop and where the record came from.
    gaps : tuple of int
        Rows before which time is missing (the sample there does not follow its predecessor by dt).
    notes : tuple of str
        Sentences that say what was assumed when the record was read.
    loop_type : str
        What PV measures, as :func:`lostmotion.diagnose` takes it ("flow", "level" ..); empty: not known.
    made_up : (float, float)
        Shares of the samples of OP and PV that the reader put between stored values.
    start : datetime, optional
        When the first row was recorded; dates, NumPy and pandas time stamps and ISO texts are taken too. None: unknown.
    gap_seconds : tuple of float
        Seconds that are missing at each of `gaps`; empty: not known.
    op_unit, pv_unit : str
        Engineering units of OP (and the position) and of PV (and SP), e.g. "%" and "m3/h"; empty: not known.

    Raises
    ------
    DataError
        Lengths differ, fewer than two samples, or infinite values.
    ParameterError
        dt is not positive and finite, a span is empty, or the start is no date.

    Examples
    --------
    >>> LoopRecord(op=[1, 2, 3], pv=[0, 1, 2], dt=0.5, tag="FIC-101")
    LoopRecord('FIC-101': 3 samples of OP, PV every 0.5 s, 1.5 s)
    """

    op: FloatArray
    pv: FloatArray
    sp: FloatArray | None = None
    position: FloatArray | None = None
    dt: float = field(kw_only=True)
    mode: StringArray | None = field(default=None, kw_only=True)
    op_span: tuple[float, float] | None = None
    pv_span: tuple[float, float] | None = None
    tag: str = ""
    source: str = ""
    gaps: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    loop_type: str = field(default="", kw_only=True)
    made_up: tuple[float, float] = field(default=(0.0, 0.0), kw_only=True)
    start: datetime | None = field(default=None, kw_only=True)
    gap_seconds: tuple[float, ...] = field(default=(), kw_only=True)
    op_unit: str = field(default="", kw_only=True)
    pv_unit: str = field(default="", kw_only=True)

    def __post_init__(self) -> None:
        seconds("dt", self.dt)
        for name in _SIGNALS:
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, _as_signal(value, name))
        if self.mode is not None:
            object.__setattr__(self, "mode", _as_words(self.mode))
        n = len(self.op)
        for name in (*_SIGNALS[1:], "mode"):
            value = getattr(self, name)
            if value is not None and len(value) != n:
                raise DataError.expected(f"{name} with {n} samples as op", f"{len(value)}", "cut both to the same rows")
        if n < 2:
            raise DataError.expected("at least 2 samples", n, "check that the right file was read")
        for name in ("op_span", "pv_span"):
            span = getattr(self, name)
            if span is not None:
                refuse_span(name, span, getattr(self, name[:2]))
        self._set_labels()
        self._set_span()
        self._set_clock()

    def _set_labels(self) -> None:
        for name in ("tag", "source", "op_unit", "pv_unit"):
            object.__setattr__(self, name, label(getattr(self, name)))

    def _set_span(self) -> None:
        """Span of OP by its unit, where none was given."""
        if self.op_span is not None or not self.op_unit:
            return
        span, note = about_unit(self.op_unit, self.op)
        object.__setattr__(self, "op_span", span)
        if note and note not in self.notes:
            object.__setattr__(self, "notes", (*self.notes, note))

    def _set_clock(self) -> None:
        if self.start is not None:
            object.__setattr__(self, "start", as_moment(self.start))
        if self.gap_seconds and len(self.gap_seconds) != len(self.gaps):
            remedy = "give one for each gap, or none"
            raise DataError.expected(f"{len(self.gaps)} gap_seconds", len(self.gap_seconds), remedy)

    def __len__(self) -> int:
        return len(self.op)

    def __repr__(self) -> str:
        names = ", ".join(name.upper() for name in _SIGNALS if getattr(self, name) is not None)
        seconds = len(self) * self.dt
        gaps = f", {len(self.gaps)} gap{'s'[: len(self.gaps) > 1]}" if self.gaps else ""
        size = f"{len(self)} samples of {names} every {self.dt:g} s, {seconds:g} s{gaps}"
        began = f" from {self.start}" if self.start is not None else ""
        return f"LoopRecord({self.tag!r}: {size}{began})"

    @cached_property
    def missing(self) -> npt.NDArray[np.bool_]:
        """Rows in which OP or PV is missing, shape (n,)."""
        return np.isnan(self.op) | np.isnan(self.pv)

    @cached_property
    def stretch_starts(self) -> FloatArray | None:
        """Seconds from the first row to that of each stretch between gaps; None where it is not known."""
        if len(self.gap_seconds) != len(self.gaps):
            return None
        lost = np.cumsum(self.gap_seconds)
        return np.concatenate([[0.0], np.array(self.gaps, dtype=np.float64) * self.dt + lost])

    def moment(self, row: int) -> datetime | None:
        """When a row was recorded; None where it is not known: no start, or behind a gap of unknown length."""
        behind = bisect_right(self.gaps, row)
        if self.start is None or (behind and not self.gap_seconds):
            return None
        return later(self.start, row * self.dt + sum(self.gap_seconds[:behind]))

    @cached_property
    def fingerprint(self) -> str:
        """First 16 hex digits of the SHA-256 of OP, PV and dt: the same data, the same fingerprint."""
        digest = hashlib.sha256()
        for part in (self.op, self.pv, np.array([self.dt])):
            digest.update(np.ascontiguousarray(part).tobytes())
        return digest.hexdigest()[:16]

    def __getitem__(self, rows: slice) -> LoopRecord:
        """Part of the record: by rows as of a list, by times since the first row, by dates.

        Every bound may be of another kind. The lower one belongs to the part, the upper one does not, for times and
        dates as for rows (pandas takes both): neighbouring parts share no sample, and together are the whole.
        Negative times count from the end, as negative rows do; what gaps left out does not count in times.

        Raises
        ------
        ParameterError
            One row, steps over rows (see :func:`lostmotion.records.resample`), a bound of another kind, or a date of a
            record that does not say when it began.
        DataError
            Fewer than two samples there.

        Examples
        --------
        >>> record = LoopRecord(op=range(600), pv=range(600), dt=10.0, start="2026-03-01 06:00")
        >>> record[100:500]
        LoopRecord('': 400 samples of OP, PV every 10 s, 4000 s from 2026-03-01 06:16:40)
        >>> record["10min":"1h30min"].op[[0, -1]].tolist(), len(record["-1h":])
        ([60.0, 539.0], 360)
        >>> record["2026-03-01 07:00":"2026-03-01 07:20"]
        LoopRecord('': 120 samples of OP, PV every 10 s, 1200 s from 2026-03-01 07:00:00)
        """
        if not isinstance(rows, slice) or rows.step not in (None, 1):
            raise ParameterError.expected("rows as start:stop", repr(rows), "e.g. record[100:500]")
        start, stop, _ = slice(bound(self, rows.start), bound(self, rows.stop)).indices(len(self))
        if stop - start < 2:
            raise nothing_there(self, rows, max(stop - start, 0))
        return self.cut(start, stop)

    def between(self, start: float, stop: float) -> LoopRecord:
        """Rows from `start` to `stop` seconds after the first one (exclusive); what gaps left out does not count."""
        return self[max(round(start / self.dt), 0) : max(round(stop / self.dt), 0)]

    def check(self) -> CheckedRecord:
        """What ``lostmotion check`` finds: the report, and what of the record an identification would use.

        Examples
        --------
        >>> found = LoopRecord(op=[50.0] * 300, pv=list(range(300)), dt=1.0).check()
        >>> found.usable, found.report.findings[0].what
        (False, 'OP is constant (50).')
        """
        from lostmotion.records.checked import CheckedRecord  # noqa: PLC0415  it looks at records itself

        return CheckedRecord.of(self)

    def plot(self, **options: Any) -> Any:
        """Figure: PV with SP and OP over time, PV over OP beside them where both move.

        ``figure=`` draws into a matplotlib Figure or SubFigure instead of a new one, ``ax=`` the trend alone into an
        Axes. Needs the extra ``lostmotion[plot]``; returns the matplotlib Figure.

        Raises
        ------
        ParameterError
            Both `figure` and `ax`.
        """
        return _verbs.plot(self, **options)

    def _repr_html_(self) -> str:
        """Table for notebooks: what the record holds and what was assumed."""
        rows = [("Loop", self.tag or "-"), ("Source", self.source or "-"), ("Record", repr(self))]
        units = ((name, unit) for name, unit in (("Unit of OP", self.op_unit), ("Unit of PV", self.pv_unit)) if unit)
        rows += [*units, *(("Read so", note) for note in self.notes)]
        return html_table(rows, named=True)

    def cut(self, start: int, stop: int) -> LoopRecord:
        """Rows start to stop (exclusive) as a record of its own."""
        start, stop, _ = slice(start, stop).indices(len(self))
        rows = slice(start, stop)
        parts = {name: getattr(self, name) for name in (*_SIGNALS, "mode")}
        cut: dict[str, Any] = {name: None if value is None else value[rows] for name, value in parts.items()}
        inside = [number for number, row in enumerate(self.gaps) if start < row < stop]
        cut["gaps"] = tuple(self.gaps[number] - start for number in inside)
        cut["gap_seconds"] = tuple(self.gap_seconds[number] for number in inside) if self.gap_seconds else ()
        return replace(self, **cut, start=self.moment(start))

    def split(self, shortest: int = 2) -> list[LoopRecord]:
        """Contiguous pieces without missing samples or gaps, none shorter than `shortest` samples."""
        edges = {0, len(self), *self.gaps}
        change = np.flatnonzero(np.diff(self.missing.astype(np.int8))) + 1
        edges.update(int(row) for row in change)
        ordered = sorted(edges)
        return [
            self.cut(start, stop)
            for start, stop in pairwise(ordered)
            if not self.missing[start] and stop - start >= max(shortest, 2)
        ]


def fingerprint_of(records: Sequence[str]) -> str:
    """Fingerprint of several records from theirs, in this order; of a single one its own."""
    return records[0] if len(records) == 1 else hashlib.sha256("".join(records).encode()).hexdigest()[:16]


def refuse_span(name: str, span: tuple[float, float], values: FloatArray) -> None:
    """ParameterError for what is no span of these values (n,)."""
    if not span[0] < span[1]:
        raise ParameterError.expected(f"{name} with low < high", span, "give (low, high)")
    largest = max(float(np.max(np.abs(values), initial=0.0, where=np.isfinite(values))), 1.0)
    if not max(map(abs, span)) <= MOST_SPAN * largest:
        remedy = f"give the limits of {name[:2].upper()} in its units"
        raise ParameterError.expected(f"{name} within +-{MOST_SPAN * largest:.3g}", span, remedy)


def _as_signal(value: npt.ArrayLike, name: str) -> FloatArray:
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise DataError.expected(f"{name} as numbers", type(value).__name__, "convert it to floats") from error
    if array.ndim != 1:
        raise DataError.expected(f"{name} of one dimension", f"shape {array.shape}", "pass one column")
    wild = np.abs(array) > LARGEST
    if wild.any():
        row = int(np.flatnonzero(wild)[0])
        raise DataError.expected(
            f"finite {name} below {LARGEST:g}", f"{array[row]} in row {row}", "mark missing samples as NaN"
        )
    array.setflags(write=False)
    return array


def _as_words(value: npt.ArrayLike) -> StringArray:
    array = np.array(value, dtype=np.str_)
    if array.ndim != 1:
        raise DataError.expected("mode of one dimension", f"shape {array.shape}", "pass one word a row")
    array.setflags(write=False)
    return array
