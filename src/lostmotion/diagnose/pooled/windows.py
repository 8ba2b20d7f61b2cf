"""A long record is read by its informative windows, as many records of one valve."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.pooled.pooled_diagnosis import PooledDiagnosis
from lostmotion.diagnose.pooled.settings import DiagnosisSettings
from lostmotion.diagnose.pooled.together import DAY, Say, diagnose_together
from lostmotion.diagnose.ringing import judged_by_amplitude
from lostmotion.errors import DataError
from lostmotion.identify import identify
from lostmotion.models.linear import SETTLING
from lostmotion.records import LoopRecord
from lostmotion.records.resample import pick

LONG = 50_000  # rows: a fit of more takes minutes, and its process is not the same all the time
ROWS = 750, 1500  # of a window, fewest and most, after thinning: lost motion shows in a few turns of OP
MOST = 14  # windows: what a minute of work allows
PIECE = 4096  # rows from which the pace is taken, at places all over the record
PIECES = 5
LAGS = 50  # time constants of the process in a window: some thirty settling times of a loop tuned for it
FINEST = 60.0  # rows in a time constant: more are thinned, though OP between the rows kept is not seen
KNOWN = 0.9  # share of the rows of a window that must be there
MOVE = 30.0  # turns of OP that a move of SP is worth: noise and drift, which also make turns, hide what the valve does


@dataclass(frozen=True)
class _Pace:
    """How a long record is cut."""

    thinned: int  # every so many-th row
    rows: int  # of the record in a window


def diagnose_long(record: LoopRecord, asked: DiagnosisSettings, say: Say | None = None) -> PooledDiagnosis:
    """Diagnose the valve of a long record from its most informative windows.

    Windows are some fifty time constants of the process long, and thinned where the record is much faster than that;
    those are read in which SP moves and OP turns most, one of every part of the record. Beside the record no more than
    these windows and the models of them are in memory.

    Raises
    ------
    DataError
        No window can be used.
    """
    pace = _pace(record)
    starts = np.arange(0, len(record) - pace.rows + 1, pace.rows)
    scores = np.array([_score(record, int(start), pace) for start in starts])
    chosen = _spread(scores)
    windows = []
    for start in starts[chosen].tolist():
        window = record.cut(start, start + pace.rows)
        windows.append(_named(pick(window, pace.thinned, 0) if pace.thinned > 1 else window, start * record.dt))
    if not windows:
        raise DataError.expected("a window in which OP and PV move", "none", "check the record")
    times = [float(start) * record.dt for start in starts[chosen]]
    found = diagnose_together(windows, asked, times, say, singly=False, of_windows=len(starts))
    return judged_by_amplitude(replace(found, origin=record.fingerprint), record)


def _named(window: LoopRecord, start: float) -> LoopRecord:
    """With its place in the record for a name."""
    days, rest = divmod(start, DAY)
    hours, seconds = divmod(rest, 3600.0)
    return replace(window, tag=f"day {days:.0f} {hours:02.0f}:{seconds / 60.0:02.0f}")


def _pace(record: LoopRecord) -> _Pace:
    """From the time constant of a linear process, at places all over the record."""
    size = min(PIECE, len(record) // PIECES)
    places = np.linspace(0, len(record) - size, PIECES).astype(np.int64)
    found = [_lag(record.cut(start, start + size)) for start in places.tolist()]
    lag = float(np.median([one for one in found if one > 0.0] or [1.0]))
    thinned = max(int(lag / FINEST), 1)
    rows = int(np.clip(LAGS * lag / thinned, *ROWS)) * thinned
    return _Pace(thinned, min(rows, len(record)))


def _lag(piece: LoopRecord) -> float:
    """Rows of the slowest lag of a linear process; 0 where there is none to be seen."""
    try:
        return identify(piece, nonlinearity="none").linear.slowest_lag(within=SETTLING)
    except DataError:
        return 0.0


def _score(record: LoopRecord, start: int, pace: _Pace) -> float:
    """Moves of SP and turns of OP in a window; -inf where it cannot be used."""
    rows = slice(start, start + pace.rows, pace.thinned)
    op, pv = record.op[rows], record.pv[rows]
    known = np.isfinite(op) & np.isfinite(pv)
    if known.mean() < KNOWN or np.ptp(op[known]) == 0.0 or np.ptp(pv[known]) == 0.0:
        return float("-inf")
    op = op[known]
    score = float(_turns(op))
    if record.sp is not None:
        sp = record.sp[rows]
        steps = np.abs(np.diff(sp[np.isfinite(sp)]))
        score += MOVE * float(np.count_nonzero(steps > 0.05 * np.std(pv[known])))
    return score * float(np.ptp(op))


def _turns(op: FloatArray) -> int:
    """Times that OP turned by more than its deviation."""
    marks = np.round((op - op.mean()) / max(float(op.std()), 1e-300))
    moves = np.sign(np.diff(marks))
    return int(np.count_nonzero(np.diff(moves[moves != 0.0])))


def _spread(scores: FloatArray) -> FloatArray:
    """Numbers of the best windows, the best of every part of the record among them, in order."""
    usable = np.flatnonzero(np.isfinite(scores))
    parts = np.array_split(usable, min(MOST, len(usable))) if usable.size else []
    return np.array([part[int(np.argmax(scores[part]))] for part in parts], dtype=np.int64)
