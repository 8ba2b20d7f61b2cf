"""``actuator_response``: from OP and the measured position to what the actuator does."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.actuator import holds as hold_events
from lostmotion.actuator import play as plays
from lostmotion.actuator import slip as slip_fit
from lostmotion.actuator.holds import Holds, Threshold, holds_of, threshold_of
from lostmotion.actuator.load import load_motion
from lostmotion.actuator.play import Play, fit_play, simulated
from lostmotion.actuator.rate import rate_limit
from lostmotion.actuator.response import CANNOT_TELL, NONE, ActuatorResponse, ActuatorStatus
from lostmotion.actuator.samples import Samples, samples_of
from lostmotion.actuator.slip import Slip, as_slip, fit_slip
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord, RecordLike, as_record
from lostmotion.records.span import possible_spans

FEWEST_ROWS = 30
FLAT = 5.0  # resolutions that OP and position must move
MATTERS = 1.5  # % of span: "none" excludes a larger dead band
FINE_STEPS = 1.0  # % of span: a dead band that a tenth of the steps of OP cross at once could be hidden; no more
SIGNIFICANT = 8.0  # log-likelihood over the actuator without a play, in independent rows: odds of some 1000 to 1
SLIPS_GAIN = 10.0  # log-likelihood of stick and slip over a play
SURE_GAIN = 100.0  # the same, where no single slip is seen: the model of the noise may be wrong
SHORT_REST = 0.5  # of the half band, left behind after a slip
SLIPS = 3  # holds that end as they began: one may be a disturbance
SAWTOOTH = 0.1  # of the length of a slip: scale of what a play leaves of it, 1 / sqrt(12) of a full one
PLAY_MODEL = 0.02  # of the dead band: positioners and links repeat no better
HOLDS_MODEL = 0.03  # of the dead band: the threshold of one direction is not that of the other
UNRESOLVED = 6.0  # scales of the residuals: a dead band that a few reversals may hide in them
SLIP_MODEL = 0.25  # of the dead band: friction is not the model that is fitted
SLIP_OVER_PLAY = 3.0  # dead band of a complete slip over the play that fits it best, at most
PARTIAL_SLIP = 0.75  # of the half band, left behind after a slip: with more it is a play
VISIBLE = 7.5  # scales of the residuals: slips of a narrower band could not be seen
MISFIT = 2.5  # noises of the position: residuals of a larger scale are not those of a play
NEAR_PLAY = 0.9  # of the half band, left behind after a slip: with less a play is not sure
STEP_TIMING = 0.03  # of a step of OP: what is left of it at the end of the hold behind it
BENT = 0.2  # second over first differences of OP: a controller that acts on noise has 1 and more
EXACT = 0.25  # of the dead band that "none" excludes: residuals of a smaller scale show it at each reversal
FEW_REVERSALS, MANY_REVERSALS = 2, 30  # that "none" needs: with exact residuals, and with others, by their mean
WIDEST = 2.0  # upper over lower end of an interval from which on the size is not known


def actuator_response(
    record: RecordLike | None = None,
    *,
    op: str | npt.ArrayLike | None = None,
    position: str | npt.ArrayLike | None = None,
    dt: float | None = None,
    **columns: Any,
) -> ActuatorResponse:
    """Estimate dead band, resolution, rate limit, lag and offset of an actuator from OP and its measured position.

    Parameters
    ----------
    record : LoopRecord, path, data frame or dict of columns, optional
        With OP and position. Without a position its PV counts as the position.
    op, position : array_like, shape (n,), or str
        Arrays where there is no record; the names of the columns where one is read.
    dt : float, optional
        Sampling time in seconds; needed with arrays.
    **columns
        More settings of :func:`lostmotion.read_loop` where a record is read (pv, time, op_span ..).

    Returns
    -------
    ActuatorResponse

    Raises
    ------
    DataError
        The record cannot be read.
    ParameterError
        Neither a record nor arrays, or arrays without `dt`.

    Notes
    -----
    Two descriptions of the actuator are compared. A play behind or before a lag, with a rate limit, is fitted by
    simulation. A threshold is fitted to the holds, each of which bounds it. Where single slips are near the noise, a
    filter over hold and slip takes the place of the holds. A position that moves at a constant OP is moved by a load;
    the range is then the lost motion.

    Examples
    --------
    >>> import numpy as np, lostmotion as lm
    >>> op = 50.0 + 10.0 * np.sin(np.arange(600) / 40.0)
    >>> valve = lm.Backlash(width=2.0)
    >>> response = lm.actuator_response(op=op, position=valve(op), dt=1.0)
    >>> response.kind, round(response.dead_band, 2)
    ('backlash', 2.0)
    """
    return _response(_as_loop_record(record, op, position, dt, columns))


def _as_loop_record(record: Any, op: Any, position: Any, dt: float | None, columns: dict[str, Any]) -> LoopRecord:
    if record is None:
        if op is None or position is None or dt is None:
            got = ", ".join(
                name for name, value in (("op", op), ("position", position), ("dt", dt)) if value is not None
            )
            raise ParameterError.expected("a record, or op, position and dt", got or "none", "give all three")
        values = np.asarray(position, dtype=np.float64)
        return LoopRecord(op, values, position=values, dt=dt, **columns)
    names = {name: value for name, value in (("op", op), ("position", position), ("dt", dt)) if value is not None}
    return as_record(record, **names, **columns)


def _response(record: LoopRecord) -> ActuatorResponse:
    span = _span(record)
    samples = samples_of(record)
    if int(np.count_nonzero(np.isfinite(samples.position))) < FEWEST_ROWS:
        return _unknown(record, span, ActuatorStatus.SHORT)
    least = max(FLAT * samples.resolution, 1e-9)
    moved = float(np.nanmax(samples.position) - np.nanmin(samples.position))
    if samples.op_range <= least or moved <= least:
        return _unknown(record, span, ActuatorStatus.FLAT)
    loaded = load_motion(samples)
    rate = rate_limit(samples)
    if loaded is not None:
        return ActuatorResponse(
            "backlash", loaded.band, loaded.interval, ActuatorStatus.LOAD, up=loaded.band, down=loaded.band,
            resolution=samples.resolution, rate_limit=rate / samples.dt, offset=loaded.offset, span=span,
            record=record, events=loaded.moves,
        )  # fmt: skip
    return _Evidence.of(samples.most_informative(), rate).response(record, span)


def _threshold_by_holds(samples: Samples) -> tuple[Holds, Threshold | None, int, float]:
    """Holds, their threshold, and how many slips of which travel: of the window that shows most of them."""
    found: list[tuple[Holds, Threshold | None, int, float]] = []
    for factor in hold_events.WINDOWS:
        holds = holds_of(samples, factor * hold_events.smallest_window(samples))
        threshold = threshold_of(samples, holds)
        slips, travel = (0, 0.0) if threshold is None else hold_events.slips(samples, holds, threshold)
        found.append((holds, threshold, slips, travel))
    return max(found, key=_rank)


def _rank(found: tuple[Holds, Threshold | None, int, float]) -> tuple[bool, bool, float]:
    """Order of windows: those whose holds agree and slip, then the narrowest interval."""
    _, threshold, slips, _ = found
    if threshold is None:
        return False, False, -math.inf
    low, high = threshold.interval
    return slips >= SLIPS and threshold.consistent, slips >= SLIPS, -(high - low) / threshold.half


def reversals(op: FloatArray, size: float) -> int:
    """How often OP reverses by more than `size`.

    Examples
    --------
    >>> reversals(np.array([0.0, 3.0, 1.0, 1.5, 1.2, 4.0]), 1.0)
    2
    """
    count, way, extreme = 0, 0, float("nan")
    for value in op[np.isfinite(op)].tolist():
        if math.isnan(extreme) or way * (value - extreme) > 0.0:
            extreme = value
        elif abs(value - extreme) > size:
            count += way != 0
            way, extreme = (1 if value > extreme else -1), value
    return count


def _span(record: LoopRecord) -> tuple[float, float]:
    """Span of OP: as given, as its values suggest, else the range seen."""
    if record.op_span is not None:
        return record.op_span
    seen = float(np.nanmin(record.op)), float(np.nanmax(record.op))
    possible = possible_spans(record.op_unit, np.array(seen))
    return possible[0] if possible else seen


def _unknown(record: LoopRecord, span: tuple[float, float], status: ActuatorStatus) -> ActuatorResponse:
    return ActuatorResponse(CANNOT_TELL, np.nan, (0.0, np.inf), status, span=span, record=record)


@dataclass(frozen=True, eq=False)
class _Evidence:
    """Everything that was fitted to one record."""

    samples: Samples
    rate: float
    none: Play
    play: Play
    colour: float
    holds: Holds
    threshold: Threshold | None
    slips: int
    travel: float
    slip: Slip
    slip_gain: float

    @classmethod
    def of(cls, samples: Samples, rate: float) -> _Evidence:
        """Fit all descriptions."""
        none, play = fit_play(samples, (math.inf,) if math.isinf(rate) else (math.inf, rate))
        holds, threshold, slips, travel = _threshold_by_holds(samples)
        slip = fit_slip(samples, play, threshold)
        gain = slip.log_likelihood - as_slip(samples, play).log_likelihood
        return cls(samples, rate, none, play, plays.colour(samples, play), holds, threshold, slips, travel, slip, gain)

    @property
    def play_gain(self) -> float:
        """Log-likelihood of the play over none, in independent rows."""
        return (self.play.log_likelihood - self.none.log_likelihood) / self.colour

    @property
    def seen_to_slip(self) -> bool:
        """Whether holds end in slips, of a length that the residuals of a play show too."""
        if self.threshold is None or self.slips < SLIPS:
            return False
        long = self.travel > hold_events.SAME_WAY_SHARE * self.threshold.half
        return long and self.play.scale > SAWTOOTH * self.travel

    def response(self, record: LoopRecord, span: tuple[float, float]) -> ActuatorResponse:
        """The description that the record supports."""
        base = self._base(record, span)
        if self.threshold is not None and self.threshold.consistent and self.seen_to_slip:
            return self._by_holds(base)
        partial = self.slip_gain > SLIPS_GAIN and self.slip.rest < PARTIAL_SLIP
        if partial and (self.seen_to_slip or self._surely_slips) and self.play_gain > SIGNIFICANT:
            low, high = slip_fit.band_interval(self.samples, self.slip)
            band = 2.0 * self.slip.half
            interval = min(low, band * (1.0 - SLIP_MODEL)), max(high, band * (1.0 + SLIP_MODEL))
            return self._named(replace(base, kind="stiction", dead_band=2.0 * self.slip.half, interval=interval))
        if self.play_gain > SIGNIFICANT:
            interval = self._play_interval()
            found = replace(base, kind="backlash", dead_band=2.0 * self.play.half, interval=interval)
            if not self._is_play:
                wider = (interval[0], max(SLIP_OVER_PLAY * interval[1], self._slip_at_most))
                return replace(found, kind=CANNOT_TELL, status=ActuatorStatus.AMBIGUOUS, interval=wider)
            return self._named(found)
        return self._without(base)

    def _base(self, record: LoopRecord, span: tuple[float, float]) -> ActuatorResponse:
        """What is known of every actuator: rate, lag, offset, resolution."""
        samples, best = self.samples, self.play
        delay = max(best.delay - (0.0 if best.line else 1.0), 0.0)
        return ActuatorResponse(
            CANNOT_TELL, np.nan, (0.0, np.inf), ActuatorStatus.SEEN, resolution=samples.resolution,
            rate_limit=self.rate / samples.dt, lag=(best.lag + delay) * samples.dt, offset=best.offset, span=span,
            record=record, predicted=simulated(samples, best),
        )  # fmt: skip

    def _by_holds(self, base: ActuatorResponse) -> ActuatorResponse:
        threshold = self.threshold
        assert threshold is not None  # noqa: S101  checked by the caller
        up, down = hold_events.directions(self.samples, self.holds, threshold)
        band = 2.0 * threshold.half
        low, high = (
            2.0 * (1.0 + side * HOLDS_MODEL) * end for side, end in zip((-1.0, 1.0), threshold.interval, strict=True)
        )
        return self._named(replace(
            base, kind="stiction", dead_band=band, interval=(low, high),
            up=float(np.median(up)) if len(up) else band, down=float(np.median(down)) if len(down) else band,
            offset=threshold.offset, events=threshold.events, resolution=max(self.travel, self.samples.resolution),
        ))  # fmt: skip

    @property
    def _surely_slips(self) -> bool:
        """Whether the filter finds slips that leave little behind, of a band that the play agrees with."""
        agrees = self.play.half < self.slip.half < SLIP_OVER_PLAY * self.play.half
        return self.slip_gain > SURE_GAIN and self.slip.rest < SHORT_REST and agrees

    @property
    def _is_play(self) -> bool:
        """Whether a play explains the position to its noise, and slips would have been visible."""
        slips = self.slip_gain > SLIPS_GAIN and self.slip.rest < NEAR_PLAY
        visible = 2.0 * self.play.half >= VISIBLE * self.play.scale
        return visible and not slips and self.play.scale < MISFIT * self.samples.noise

    def _play_interval(self) -> tuple[float, float]:
        """Interval of a play, with what the model and the sampling of OP leave open."""
        low, high = plays.band_interval(self.samples, self.play, self.colour)
        error = PLAY_MODEL * 2.0 * self.play.half + self._timing()
        return max(low - error, 0.0), high + error + self._unseen()

    def _timing(self) -> float:
        """Way of OP in the time by which its changes are uncertain, where the fit found them so."""
        moving = np.abs(np.diff(self.samples.op))
        moving = moving[np.isfinite(moving) & (moving > 0.0)]
        if len(moving) == 0 or (self.play.jitter == 0.0 and not self._smooth):
            return 0.0
        return (plays.JITTER if self._smooth else STEP_TIMING) * float(np.median(moving))

    @property
    def _smooth(self) -> bool:
        """Whether OP is a ramp or a slow wave that goes on between its samples."""
        op = self.samples.op
        bend, slope = float(np.nanmedian(np.abs(np.diff(op, 2)))), float(np.nanmedian(np.abs(np.diff(op))))
        return self.play.line and bend < BENT * slope

    @property
    def _slip_at_most(self) -> float:
        """Largest dead band that the best fit of stick and slip leaves open."""
        return 2.0 * (1.0 + SLIP_MODEL) * self.slip.half

    def _unseen(self) -> float:
        """How much farther OP went at its turns than its samples show, where it moves in lines between them."""
        if not self._smooth:
            return 0.0
        steps = np.diff(self.samples.op)
        turns = np.flatnonzero(steps[1:] * steps[:-1] < 0.0)
        return float(np.median(np.abs(steps[turns]))) if len(turns) else 0.0

    def _named(self, found: ActuatorResponse) -> ActuatorResponse:
        """With its size, or "cannot tell" where the interval is too wide for one."""
        low, high = found.interval
        if high > WIDEST * low:
            wider = (low, max(SLIP_OVER_PLAY * high, self._slip_at_most))
            return replace(found, kind=CANNOT_TELL, status=ActuatorStatus.WIDE, interval=wider)
        ends: dict[str, Any] = {
            name: found.dead_band for name in ("up", "down") if not np.isfinite(getattr(found, name))
        }
        return replace(found, status=ActuatorStatus.SEEN, **ends)

    def _without(self, base: ActuatorResponse) -> ActuatorResponse:
        """No dead band is seen: the largest one that the record leaves open."""
        if self.slip_gain > SLIPS_GAIN and self.slip.rest < PARTIAL_SLIP and self.seen_to_slip:
            return replace(base, interval=(0.0, SLIP_OVER_PLAY * 2.0 * self.slip.half), status=ActuatorStatus.AMBIGUOUS)
        _, high = plays.band_interval(self.samples, self.none, self.colour)
        steps = np.abs(np.diff(self.samples.op))
        steps = steps[np.isfinite(steps) & (steps > 0.0)]
        hidden = 2.0 * float(np.quantile(steps, 0.1)) if len(steps) else np.inf
        steady = len(steps) > hold_events.STEADY_SHARE * len(self.samples)
        coarse = hidden > (MATTERS if steady else FINE_STEPS) * base.percent
        high = max(high, hidden)
        needed = FEW_REVERSALS if self.none.scale < EXACT * high else MANY_REVERSALS
        if not coarse and high <= MATTERS * base.percent and reversals(self.samples.op, high) >= needed:
            return replace(base, kind=NONE, dead_band=0.0, interval=(0.0, high), status=ActuatorStatus.NONE)
        if reversals(self.samples.op, high) < needed:
            high = max(high, UNRESOLVED * self.none.scale)
        if self.slip_gain > SLIPS_GAIN:
            high = max(high, self._slip_at_most)
        return replace(base, interval=(0.0, high), status=ActuatorStatus.COARSE if coarse else ActuatorStatus.OPEN)
