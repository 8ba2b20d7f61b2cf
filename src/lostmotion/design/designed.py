"""TestDesign: the test to ask for, and what it is expected to tell."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from lostmotion import _verbs
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief
from lostmotion.design.operating_limits import Limits
from lostmotion.design.simulated_plant import Plant
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.records import LoopRecord
from lostmotion.simulate import PI
from lostmotion.summary import Summary


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(Brief):
    """What is expected to be seen, each of shape (n,).

    Attributes
    ----------
    op, pv : OP and PV of the model as given, without noise
    pv_low, pv_high : band that holds PV in all plausible plants, noise included
    op_low, op_high : the same for OP; in open loop OP itself
    """

    op: FloatArray
    pv: FloatArray
    pv_low: FloatArray
    pv_high: FloatArray
    op_low: FloatArray
    op_high: FloatArray

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (f"{self.op.size} samples",)


@dataclass(frozen=True, eq=False, repr=False)
class TestDesign(Brief):
    """Result of :func:`design`. Frozen; prints, draws and writes itself.

    Attributes
    ----------
    signal : ndarray, shape (n,)
        OP (open loop) or SP (closed loop), one value every `dt` seconds.
    expected : dict of float
        Half-widths of the 95 % intervals that an efficient estimator reaches if the model as given is true: left,
        right, width in units of OP, slope_ratio, gain (with right_slope 1 by convention).
    expected_typical, expected_worst : dict of float
        Median and largest over the plausible plants.
    prs_expected : dict of float
        The same as `expected` for a pseudo-random staircase of the same length, limits and shortest hold: median over
        seeds. `prs_by_hold` holds those with longer holds, by the hold in seconds.
    goals : dict of float
        What the test was made for: `wanted`, or 1 for each parameter whose smallest interval was sought.
    target : str
        What is drawn: the parameter of `goals` that is furthest from its goal.
    growth : dict of ndarray
        Half-width of `target` after some time: time_s, model (the model as given) and assured (reached by four
        plausible plants in five).
    wanted : dict of float or None
        As asked for.
    reached : bool
        Whether `wanted` is reached by the model as given and by four plausible plants in five, and none misses it by
        more than three times ("worst": by every one); where nothing was wanted, whether the test tells anything.
    reached_by : float
        Share of the plausible plants on which `wanted` is reached; 1 where nothing was wanted.
    advice : tuple of str
        What would have to be relaxed, where it is not reached.
    break_points : dict of (float, float)
        Where `left` and `right` plausibly are, in units of OP.
    prediction : Prediction
    model, noise, controller, limits, op_now : what it was made for
    settings : dict
        As asked for, and what was assumed.
    """

    __test__: ClassVar[bool] = False  # no test case, for pytest

    signal: FloatArray
    dt: float
    loop: str
    steps: tuple[tuple[float, float], ...]
    expected: dict[str, float]
    expected_typical: dict[str, float]
    expected_worst: dict[str, float]
    prs_expected: dict[str, float]
    prs_by_hold: dict[float, dict[str, float]]
    goals: dict[str, float]
    target: str
    growth: dict[str, FloatArray]
    wanted: dict[str, float] | None
    reached: bool
    reached_by: float
    advice: tuple[str, ...]
    break_points: dict[str, tuple[float, float]]
    prediction: Prediction
    model: Hammerstein
    noise: NoiseModel
    controller: PI | None
    op_now: float
    limits: Limits
    settings: dict[str, Any] = field(repr=False)

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        reach = f"width +-{self.expected['width']:.3g}"
        return f"{self.loop} loop", f"{self.duration:g} s", reach, "" if self.reached else "NOT reached"

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self.signal) * self.dt

    @property
    def moved(self) -> str:
        """Name of the signal: OP or SP."""
        return "OP" if self.loop == "open" else "SP"

    @property
    def gain_over_prs(self) -> float:
        """How many times wider the interval of a PRS of the same length, limits and hold is.

        With several goals: that of each one's parameter which is furthest from its goal.
        """
        return _ratio(self._furthest(self.prs_expected), self._furthest(self.expected))

    @property
    def gain_over_best_prs(self) -> float:
        """The same against the PRS whose hold does best."""
        best = self.prs_by_hold[self.best_prs_hold]
        return _ratio(self._furthest(best), self._furthest(self.expected))

    @property
    def best_prs_hold(self) -> float:
        """Hold in seconds with which a PRS does best."""
        return min(self.prs_by_hold, key=lambda hold: self._furthest(self.prs_by_hold[hold]))

    def _furthest(self, values: dict[str, float]) -> float:
        return max(values[name] / goal for name, goal in self.goals.items())

    def simulate(self, seed: int, model: Hammerstein | None = None) -> LoopRecord:
        """A record of the test as it would be with other noise, for ``identify``.

        Parameters
        ----------
        seed : int
            Of the noise.
        model : Hammerstein, optional
            Another plant than the one that the design was made for, from rest at the same OP.
        """
        plant = Plant(self.model if model is None else model, self.noise, self.op_now, self.controller)
        op, pv = plant.run(self.signal, seed)
        sp = None if self.controller is None else self.signal
        return LoopRecord(op, pv, sp, dt=self.dt, tag="designed test", source="simulation")

    def columns(self, every_sample: bool = True) -> dict[str, FloatArray]:
        """Table to write: time in seconds and OP or SP, every sample or only where a move begins."""
        if every_sample:
            return {"time_s": np.arange(self.signal.size, dtype=np.float64) * self.dt, self.moved: self.signal}
        table = np.array(self.steps, dtype=np.float64)
        return {"time_s": table[:, 0], self.moved: table[:, 1]}

    def summary(self) -> Summary:
        """Report as text."""
        return Summary(_verbs.text(self), self)

    def plot(self, **options: Any) -> Any:
        """Figure: signal, predicted PV with its band and limits, expected interval against time.

        ``figure=`` draws into a matplotlib Figure or SubFigure, ``title=`` replaces the heading. Needs the extra
        ``lostmotion[plot]``; returns the matplotlib Figure.
        """
        return _verbs.plot(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the samples. Infinite numbers become None."""
        return {
            "loop": self.loop,
            "duration_s": self.duration,
            "dt": self.dt,
            "samples": int(self.signal.size),
            "steps": [list(step) for step in self.steps],
            "wanted": None if self.wanted is None else dict(self.wanted),
            "reached": self.reached,
            "reached_by": self.reached_by,
            "advice": list(self.advice),
            "expected_95": _finite(self.expected),
            "expected_95_typical": _finite(self.expected_typical),
            "expected_95_worst": _finite(self.expected_worst),
            "prs_expected_95": _finite(self.prs_expected),
            "prs_expected_95_by_hold_s": {f"{hold:g}": _finite(values) for hold, values in self.prs_by_hold.items()},
            "goals": dict(self.goals),
            "target": self.target,
            "gain_over_prs": _number(self.gain_over_prs),
            "gain_over_best_prs": _number(self.gain_over_best_prs),
            "growth": {name: [_number(value) for value in values.tolist()] for name, values in self.growth.items()},
            "break_points": {name: list(ends) for name, ends in self.break_points.items()},
            "model": self.model.to_dict(),
            "noise": self.noise.to_dict(),
            "controller": None if self.controller is None else _finite(vars(self.controller)),
            "op_now": self.op_now,
            "settings": copy.deepcopy(self.settings),
        }

    def __str__(self) -> str:
        return self.summary()


def _ratio(rival: float, own: float) -> float:
    """How many times wider; 1 where neither tells anything, infinite where only the rival is blind."""
    if np.isinf(own):
        return 1.0 if np.isinf(rival) else 0.0
    return float(rival / own)


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    return {name: _number(value) for name, value in values.items()}


def _number(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
