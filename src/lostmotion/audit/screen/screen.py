"""``screen``: health, operation and oscillation of a window, and what a diagnosis of it is worth; milliseconds."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.audit.screen.harris import harris_of, natural_factor
from lostmotion.audit.screen.health import Health, health_of
from lostmotion.audit.screen.lines import lines_of
from lostmotion.audit.screen.of_loop import of_loop
from lostmotion.audit.screen.scatter import scatter
from lostmotion.audit.screen.windows import in_utc, seconds_of_rows
from lostmotion.audit.screen.worth import Seen, worth
from lostmotion.audit.settings import AuditSettings
from lostmotion.diagnose.audit_class import MOST_OPEN, audit_class
from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.control_error.spectrum import Spectrum, spectrum_of
from lostmotion.diagnose.control_error.swing import Swing, amplitude_spread, nonlinearity, phase_at, swing_of
from lostmotion.diagnose.frozen import frozen_share
from lostmotion.diagnose.performance import NOISE_BANDS
from lostmotion.errors import LostMotionError
from lostmotion.kernels.threads import one_thread
from lostmotion.kernels.turns import turns
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import AssessmentRow, SpectrumRow, Stage

MIDDLE = (0.02, 0.98)  # quantiles of OP: a single excursion shows no lost motion
MOVES = 8192  # of OP, from all over the window, of which the noise is taken
NOISE = 1.4826  # deviation over median absolute value


@dataclass(frozen=True)
class _Loop:
    """What was measured of the signals."""

    spectrum: Spectrum | None
    swing: Swing | None
    harris: float | None
    factor: int


@one_thread
def screen(
    loop: PlantLoop, record: LoopRecord, start: datetime, end: datetime, settings: AuditSettings
) -> tuple[AssessmentRow, SpectrumRow | None]:
    """Look at a window without diagnosing it.

    Nothing is raised: what goes wrong makes a row of stage "failed" with its error.

    Parameters
    ----------
    loop : PlantLoop
    record : LoopRecord
        Of the window (:func:`lostmotion.audit.screen.windows.windows_of`).
    start, end : datetime
        Of the window, UTC.
    settings : AuditSettings
    """
    began = time.process_time()
    row = AssessmentRow(
        loop.tag, start, end, fingerprint=record.fingerprint, stamp=loop.stamp, settings=settings.digest(),
        rows=len(record), dt=record.dt,
    )  # fmt: skip
    try:
        with np.errstate(all="ignore"):  # huge values overflow in squares; what is not finite is left out
            row, spectrum = _screened(row, ScreenRows(of_loop(loop, record)), settings, loop.slave)
    except Exception as error:  # noqa: BLE001  one loop in thousands must not end the run
        row, spectrum = failed(row, error), None
    return replace(row, seconds=time.process_time() - began), spectrum


def failed(row: AssessmentRow, error: Exception) -> AssessmentRow:
    """The row with an error in one line."""
    known = isinstance(error, LostMotionError)
    said = " ".join(str(error).split())
    return replace(row, stage=Stage.FAILED, error=said if known else f"{type(error).__name__}: {said}", value=0.0)


def _screened(
    row: AssessmentRow, rows: ScreenRows, settings: AuditSettings, slave: str
) -> tuple[AssessmentRow, SpectrumRow | None]:
    health, one = health_of(rows), _loop(rows)
    manual, limited = rows.share(rows.manual), rows.share(rows.limited & ~rows.manual)
    variability, (travel, reversals) = _variability(rows), _movement(rows)
    performance = _performance(rows, one, manual + limited)
    seen = Seen(
        health.fit, int(rows.acting.sum()), manual, limited, _op_range(rows), _turns(rows),
        variability if rows.record.pv_span else None,
        one.swing.power if one.swing else 0.0, bool(one.swing and one.swing.steady), performance,
        100.0 * settings.tolerance, slave,
    )  # fmt: skip
    value, reason = worth(seen, health.problem)
    row = replace(
        row, reason=reason, value=value, health=health.findings, fit_for_use=health.fit, performance=performance,
        manual=manual, limited=limited, missing=health.missing, travel=travel, reversals=reversals,
        variability=variability, harris=one.harris, indices=_indices(rows, one, health, seen), **_of_swing(one.swing),
    )  # fmt: skip
    return row, _spectrum_row(row, rows, one)


def _loop(rows: ScreenRows) -> _Loop:
    error, dt = rows.error, rows.record.dt
    spectrum = spectrum_of(error, dt)
    if spectrum is None:
        return _Loop(None, None, None, 1)
    factor = natural_factor(spectrum.corner(), dt)
    op = np.where(rows.live, rows.record.op, np.nan)
    return _Loop(spectrum, swing_of(error, spectrum, dt), harris_of(error, op, factor), factor)


def _of_swing(swing: Swing | None) -> dict[str, Any]:
    if swing is None:
        return {"period": None, "regularity": None, "power": None}
    return {"period": swing.period, "regularity": swing.regularity, "power": swing.power}


def _indices(rows: ScreenRows, one: _Loop, health: Health, seen: Seen) -> dict[str, float]:
    """Further numbers: what the assessment needs of the screen, and what a page shows."""
    found = {
        "acting_rows": float(seen.acting),
        "op_range_percent": seen.op_range,
        "op_turns": seen.turns,
        "stale": health.stale,
        "stuck": frozen_share(rows),
        "rows_in_block": float(one.factor),
        "swings": float(seen.steady),
        "pv_span_known": float(rows.record.pv_span is not None),
        "op_span_known": float(rows.span is not None and rows.span.known),
        "scatter_percent": _scatter(rows),
        "amplitude_spread": _amplitude_spread(rows, one.swing),
    }
    if rows.span is not None and rows.span.others:
        found["op_span_assumed"] = 100.0 * rows.span.percent
    return {name: float(value) for name, value in found.items() if np.isfinite(value)}


def _amplitude_spread(rows: ScreenRows, swing: Swing | None) -> float:
    """Of a regular swing of the error of control; NaN where there is none."""
    regular = swing is not None and swing.regularity > 1.0
    found = amplitude_spread(rows.error, swing.period, rows.record.dt) if swing is not None and regular else None
    return float("nan") if found is None else found


def _scatter(rows: ScreenRows) -> float:
    """Of PV in % of its span; NaN where that is not known."""
    span, record = rows.record.pv_span, rows.record
    found = scatter(np.where(rows.live, record.pv, np.nan), record.dt) if span else None
    return float("nan") if found is None or span is None else 100.0 * found / (span[1] - span[0])


def _noise(op: FloatArray) -> float:
    """Moves of OP that are no reversal: a few deviations of its moves from row to row."""
    moves = np.abs(np.diff(op))
    moves = moves[np.isfinite(moves)]
    moves = moves[:: max(moves.size // MOVES, 1)]
    return NOISE_BANDS * NOISE * float(np.median(moves)) if moves.size else 0.0


def _movement(rows: ScreenRows) -> tuple[float | None, float | None]:
    """Travel in % of span and turns, per hour of the whole window."""
    if rows.span is None:
        return None, None
    op, hours = rows.record.op, (len(rows.record) - 1) * rows.record.dt / 3600.0
    count, path = turns(op, _noise(op))
    reach = rows.span.high - rows.span.low
    return _finite(100.0 * path / reach / hours) if reach > 0.0 else 0.0, _finite(count / hours)


def _turns(rows: ScreenRows) -> float:
    """Of OP while the valve follows a controller."""
    op = np.where(rows.acting, rows.record.op, np.nan)
    return float(turns(op, _noise(op))[0])


def _op_range(rows: ScreenRows) -> float:
    op = rows.record.op[rows.acting]
    if rows.span is None or not op.size or not rows.span.high > rows.span.low:
        return 0.0
    low, high = np.quantile(op, MIDDLE)
    return float((high - low) / rows.span.percent)


def _variability(rows: ScreenRows) -> float | None:
    """Deviation of the error of control, in % of the span of PV or of its own range; None: nothing to measure."""
    error = rows.error[np.isfinite(rows.error)]
    span = rows.record.pv_span or _range(rows.record.pv)
    if not error.size or span is None:
        return None
    return _finite(100.0 * float(error.std()) / (span[1] - span[0]))


def _range(values: FloatArray) -> tuple[float, float] | None:
    known = values[np.isfinite(values)]
    return (float(known.min()), float(known.max())) if known.size and float(np.ptp(known)) > 0.0 else None


def _performance(rows: ScreenRows, one: _Loop, open_share: float) -> str:
    index = one.harris
    if index is None or not np.isfinite(index):
        return "open loop" if open_share > MOST_OPEN else "unknown"
    swing = one.swing.oscillation if one.swing else None
    found = audit_class(float(np.clip(index, 0.0, 1.0)), rows.record.loop_type or "other", swing, min(open_share, 1.0))
    return str(found)


def _spectrum_row(row: AssessmentRow, rows: ScreenRows, one: _Loop) -> SpectrumRow | None:
    if one.spectrum is None:
        return None
    record, dt = rows.record, rows.record.dt
    clock = _clock(record, row.window_start)
    power = one.spectrum.bins.astype("<f4").tobytes() + lines_of(rows.error, clock, dt, one.spectrum)
    made = SpectrumRow(row.tag, row.window_start, one.spectrum.low, one.spectrum.high, power)
    swing = one.swing
    if swing is None or swing.regularity <= 1.0:
        return made
    pv, op = (np.where(rows.live, signal, np.nan) for signal in (record.pv, record.op))
    return replace(
        made,
        nonlinearity=nonlinearity(pv, swing.period, dt),
        op_nonlinearity=nonlinearity(op, swing.period, dt),
        harmonics=_finite(one.spectrum.harmonics(swing.period)),
        phase=phase_at(pv, clock, swing.period, dt),
    )


def _clock(record: LoopRecord, start: datetime) -> FloatArray:
    """Seconds of each row from the start of the window; of an undated record from its first row."""
    times = seconds_of_rows(record)
    return times if record.start is None else times + (in_utc(record.start) - start).total_seconds()


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
