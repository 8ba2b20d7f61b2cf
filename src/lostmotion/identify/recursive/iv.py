"""RecursiveIV: the paper's estimator, sample by sample, and the least-squares forms that it improves on."""

from __future__ import annotations

import math
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, finite_signal, positive, whole
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.identify.recursive.archive import pack, reading
from lostmotion.identify.recursive.iv_covariance import covariance_of_theta
from lostmotion.identify.recursive.recursive_estimate import RecursiveEstimate, Trajectory
from lostmotion.kernels.linear import is_stable
from lostmotion.kernels.recursive_iv import run as kernel
from lostmotion.kernels.recursive_iv import state as iv
from lostmotion.models import DeadZone, Hammerstein, Identity, LinearModel, Nonlinearity

INSTRUMENTS = {"riv": iv.MODEL_OUTPUT, "rls": iv.LEAST_SQUARES, "els": iv.LEAST_SQUARES}
FORMS = ("convergent", "printed")
KIND = "RecursiveIV 3"  # of the bytes
BEFORE = "RecursiveIV 2"  # without what is kept of earlier estimates and of the moves of u
FEWEST_LEVELS = 5  # of u: a static characteristic through four has as many unknowns, two break points and two slopes
DENSE = 2000  # weighted samples after which the standard errors are gathered from a part of them
_STEP: Any = kernel.step  # compiled: no signature that a type checker knows
_RUN: Any = kernel.run
_NAMES = ("left", "right", "left_slope", "right_slope")


class RecursiveIV:
    """Recursive instrumental variables with key-term separation (paper, eqs 16-26 and 31).

    Parameters
    ----------
    na, nb, delay : int
        Orders and delay of the linear part, as in ``identify``.
    gain : float or None
        Known static gain of the linear part (eq 25). None: right_slope = 1.
    forgetting : float
        lambda of the first `constant_for` samples, and lambda0 of eq 31 afterwards; in (0, 1].
    dt : float
        Sampling time in seconds, for the linear model.
    method : {"riv", "rls", "els"}
        Instruments from the model's output (the paper); recursive least squares (biased under output noise);
        extended least squares (past residuals as regressors).
    form : {"convergent", "printed"}
        See Notes.
    start_samples : int
        Samples of plain least squares before the instruments are used.
    constant_for : int
        Samples of constant forgetting; a large number keeps it for tracking.

    Notes
    -----
    As printed the method does not converge (theta0 = 10, instruments of eq 20 from the first sample: 0 of 30 runs).
    The convergent form differs in: (1) the instrument is the regressor with the measured output replaced by the
    model's (eq 20 has na + nb + 1 entries, eq 23 na + nb + 4); (2) least squares for the first `start_samples`;
    (3) theta0 = 0, P0 = 1e3; (4) the model output is simulated with the last stable parameters; (5) br >= 0 >= bl,
    both inside the range of u seen, and positive slopes are enforced on what rebuilds x, not on theta; (6) the slope
    comes from the fixed-point form of eq 26, gain mr (1 + sum a) = b0 mr + m sum b, which never divides by the
    small b0; slope ratios beyond 10 are not taken over. ``form="printed"`` has (4) only. In both nothing is
    updated in the first `delay` samples, nor where the denominator of eq 16 vanishes; and where P has grown beyond
    1e9 for want of excitation, nothing more is forgotten.

    Standard errors are those of an instrumental-variable estimate under output error, with the dependence of the
    rebuilt x on the estimate of its time included (:mod:`lostmotion.identify.recursive.iv_covariance`); they hold where
    the bias is small, so not for "rls" and "els". They hold what is left of the start, too, which goes as slowly as 1/k
    where nothing is forgotten; intervals are therefore rather too wide. Where all moves of u are multiples of a step,
    it is taken to be rounded: the standard errors of the break points hold the step / sqrt(12).

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> u = lm.signals.prs(20_000, -5, 5, hold=10, seed=0)
    >>> y = tank.simulate(u) + np.random.default_rng(0).normal(scale=0.03**0.5, size=u.size)
    >>> riv = lm.RecursiveIV(na=3, nb=2, delay=3, gain=2.2222)
    >>> trajectory = riv.run(u, y)
    >>> abs(riv.estimate.parameters["right"] - 1.0) < 0.2
    True
    """

    def __init__(
        self,
        na: int,
        nb: int,
        delay: int,
        gain: float | None = None,
        forgetting: float = 0.995,
        *,
        dt: float = 1.0,
        method: str = "riv",
        form: str = "convergent",
        start_samples: int = 500,
        constant_for: int = 2000,
    ) -> None:
        na, nb, delay = whole("na", na, 0), whole("nb", nb, 0), whole("delay", delay, 0)
        if not isinstance(method, str) or method not in INSTRUMENTS or form not in FORMS:
            raise ParameterError.expected(
                f"method in {list(INSTRUMENTS)} and form in {list(FORMS)}",
                f"{method!r}, {form!r}",
                "choose one of them",
            )
        if not 0 < finite("forgetting", forgetting) <= 1:
            raise ParameterError.expected("forgetting in (0, 1]", forgetting, "0.995 is the paper's")
        if gain is not None and finite("gain", gain) == 0:
            raise ParameterError.expected("a gain other than 0", gain, "give y per x at rest, or None")
        self._dt = positive("dt", dt)
        self.method, self.form = method, form
        constant_for, start_samples = whole("constant_for", constant_for, 0), whole("start_samples", start_samples, 0)
        printed = form == "printed"
        kind = iv.PRINTED if printed and method == "riv" else INSTRUMENTS[method]
        places = iv.Places(na, nb, delay, na if method == "els" else 0, kind, not printed)
        self._state, self._layout = iv.lay_out(places)
        self._state[iv.KNOWN_GAIN] = np.nan if gain is None else gain
        self._state[[iv.FORGETTING, iv.CONSTANT_FORGETTING]] = forgetting
        self._state[[iv.CONSTANT_FOR, iv.START]] = constant_for, 0 if printed else start_samples
        self._state[iv.SINCE], self._state[iv.DENSE] = 1.0, DENSE
        self._levels: set[float] = set()
        self._named("zone")[:] = 0.0, 0.0, 1.0, 1.0
        self._named("theta")[:] = 10.0 if printed else 0.0
        np.fill_diagonal(self._named("p"), 1e6 if printed else 1e3)

    def _named(self, name: str) -> FloatArray:
        """View of a part of the state, see :func:`lostmotion.kernels.recursive_iv.state.named`."""
        return iv.named(self._state, self._layout)[name]

    @property
    def samples(self) -> int:
        """Samples seen."""
        return int(self._layout[iv.COUNT])

    @property
    def started(self) -> bool:
        """Whether the samples of plain least squares have passed."""
        return self.samples > 0 and self.samples >= self._state[iv.START]

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""
        return self._dt

    def update(self, u: float, y: float) -> float:
        """Take one sample; return its prediction error.

        Raises
        ------
        DataError
            u or y is not a finite number; nothing has changed then.
        """
        try:
            good = math.isfinite(u) and math.isfinite(y)
        except (TypeError, OverflowError):
            good = False
        if not good:
            raise DataError.expected("finite u and y", f"u={u!s:.60}, y={y!s:.60}", "leave missing samples out")
        if len(self._levels) < FEWEST_LEVELS:
            self._levels.add(float(u))
        return float(_STEP(self._state, self._layout, float(u), float(y)))

    def run(self, u: npt.ArrayLike, y: npt.ArrayLike, every: int = 1) -> Trajectory:
        """Take all samples of u and y (n,); keep every `every`-th estimate."""
        u = finite_signal("u", u)
        y = finite_signal("y", y, u.size)
        every = min(whole("every", every, 1), u.size + 1)
        n = int(self._layout[iv.N])
        begin = self.samples
        self._take_levels(u)
        trace = np.empty((u.size // every, n + 4))
        errors = _RUN(self._state, self._layout, u, y, every, trace)
        values = {name: trace[:, n + column] for column, name in enumerate(_NAMES)}
        return Trajectory(begin + every * np.arange(1, len(trace) + 1), {**values, "theta": trace[:, :n]}, errors)

    def _take_levels(self, u: FloatArray) -> None:
        """Remember the first levels."""
        levels = iter(u.tolist() if len(self._levels) < FEWEST_LEVELS else ())
        while len(self._levels) < FEWEST_LEVELS and (level := next(levels, None)) is not None:
            self._levels.add(level)

    @property
    def estimate(self) -> RecursiveEstimate:
        """Present estimate with standard errors.

        With form="printed" the break points may be in impossible order; the model then has a linear actuator and
        the status says that nothing converged.
        """
        values, linear = self._values()
        ordered = values["left"] <= values["right"] and min(values["left_slope"], values["right_slope"]) > 0
        actuator: Nonlinearity = DeadZone(*(values[name] for name in _NAMES)) if ordered else Identity()
        covariance = self._covariance(values)
        status = self._status(covariance) if ordered else Status.CANNOT_TELL
        return RecursiveEstimate(status, Hammerstein(actuator, linear), values, covariance, self.samples)

    def _status(self, covariance: FloatArray) -> Status:
        """Gain of the right sign, both sides visited, break points known to a quarter of the range of u.

        Between few levels of u, a binary one above all, any break points do.
        """
        if len(self._levels) < FEWEST_LEVELS:
            return Status.CANNOT_TELL
        theta, zone, span = (self._named(name) for name in ("theta", "zone", "span"))
        na, nb = (int(value) for value in self._layout[: iv.DELAY])
        product = theta[na] + zone[3] * theta[na + 4 : na + 4 + nb].sum()
        errors = np.sqrt(np.abs(np.diag(covariance)[:4]))
        informed = errors[:2] < 0.25 * (span[1] - span[0])
        if informed.any() and self._state[iv.KNOWN_GAIN] * product * (1.0 + theta[:na].sum()) < 0:
            return Status.WRONG_GAIN
        known = bool(informed.all()) and span[0] < zone[0] and zone[1] < span[1]
        known = known and bool(np.all(errors[2:] < 0.5 * zone[2:])) and bool(is_stable(theta[:na].copy(), 1.0))
        return Status.OK if known else Status.CANNOT_TELL

    def _values(self) -> tuple[dict[str, float], LinearModel]:
        theta, zone = self._named("theta"), self._named("zone")
        na, nb, delay = (int(value) for value in self._layout[: iv.NE])
        b0 = theta[na] / zone[3] if zone[3] else 0.0
        linear = LinearModel(tuple(theta[:na]), (b0, *theta[na + 4 : na + 4 + nb]), delay, self.dt)
        values = {name: float(zone[column]) for column, name in enumerate(_NAMES)}
        values["width"] = values["right"] - values["left"]
        values["slope_ratio"] = values["left_slope"] / values["right_slope"] if zone[3] else float("nan")
        values["gain"] = linear.gain
        values |= {f"a{i + 1}": float(value) for i, value in enumerate(linear.a)}
        values |= {f"b{i}": float(value) for i, value in enumerate(linear.b)}
        return values, linear

    def _covariance(self, values: dict[str, float]) -> FloatArray:
        """Covariance of the named parameters, in the order of `values`."""
        size, theta = len(values), self._named("theta")
        na, nb = (int(value) for value in self._layout[: iv.DELAY])
        unknown = np.full((size, size), np.inf)
        if theta[na] == 0.0 or theta[na + 2] == 0.0:
            return unknown
        jacobian = np.empty((size, theta.size))
        for column in range(theta.size):
            shifted = theta.astype(complex)
            shifted[column] += 1e-30j
            moved = _zone_and_model(shifted, na, nb, float(self._state[iv.KNOWN_GAIN]))
            jacobian[:, column] = [np.imag(moved[name]) / 1e-30 for name in values]
        covariance = covariance_of_theta(self._state, self._layout, jacobian[:4])
        if covariance is None:
            return unknown
        return np.asarray(jacobian @ covariance @ jacobian.T) + self._between_levels(list(values))

    def _between_levels(self, names: list[str]) -> FloatArray:
        """Covariance of break points that may be anywhere between two levels of a rounded u, uniformly."""
        moves = np.zeros((len(names), 2))
        for column, (name, width) in enumerate((("left", -1.0), ("right", 1.0))):
            moves[names.index(name), column], moves[names.index("width"), column] = 1.0, width
        return float(self._state[iv.GAP]) ** 2 / 12.0 * (moves @ moves.T)

    def to_bytes(self) -> bytes:
        """Whole state; :meth:`from_bytes` continues bit by bit where this one stands."""
        labels = np.array([KIND, self.method, self.form])
        levels = np.array(sorted(self._levels))
        return pack(labels=labels, dt=np.array(self.dt), state=self._state, layout=self._layout, levels=levels)

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Estimator from the bytes of :meth:`to_bytes`.

        Raises
        ------
        DataError
            The bytes are something else.
        """
        with reading(data) as parts:
            kind, method, form = (str(label) for label in parts["labels"])
            state, layout, dt = parts["state"], parts["layout"], float(parts["dt"])
            if kind == BEFORE:
                kind, state, layout = KIND, *_grown(state, layout)
            na, nb, delay = (int(value) for value in layout[: iv.NE])
            if max((na + nb + 4) ** 2, delay) > state.size:
                raise ValueError(kind)
            new = cls(na, nb, delay, 1.0, dt=dt, method=method, form=form)
            new._take_over(kind, state, layout)
            # older bytes do not say: enough then
            new._levels = {float(level) for level in parts.get("levels", np.arange(float(FEWEST_LEVELS)))}
        return new

    def _take_over(self, kind: str, state: FloatArray, layout: IntArray) -> None:
        """Take state and layout of an equal estimator; ValueError where they do not fit: the kernel does not look."""
        moving = list(iv.MOVING)
        fixed = self._layout.copy()
        fixed[moving] = layout[moving]
        now_u, now_z = layout[iv.NOW_U], layout[iv.NOW_Z]
        rings = 0 <= now_u < layout[iv.PAST_U] and 0 <= now_z <= layout[iv.NA] and layout[iv.COUNT] >= 0
        same = state.shape == self._state.shape and state.dtype == np.float64 and layout.dtype == np.int64
        if kind != KIND or not (rings and same and np.array_equal(fixed, layout)):
            raise ValueError(kind)
        self._state[:], self._layout[:] = state, layout


def _grown(state: FloatArray, layout: IntArray) -> tuple[FloatArray, IntArray]:
    """State and layout of the format before with room for what has come since; ValueError where they are none."""
    if layout.shape != (iv.FIRST_ENTRIES,) or not 0 <= layout[iv.PAD] <= state.size:
        raise ValueError("layout")
    pad = int(layout[iv.PAD])
    theta = state[layout[iv.THETA] : layout[iv.THETA] + pad]
    return np.concatenate([state, theta, theta]), np.append(layout, state.size)


def _zone_and_model(theta: npt.NDArray[Any], na: int, nb: int, gain: float) -> dict[str, Any]:
    """Named parameters as functions of theta at the fixed point (eq 26), for the chain rule."""
    a, later = theta[:na], theta[na + 4 : na + 4 + nb]
    bottom = 1.0 + a.sum()
    b0 = theta[na] if np.isnan(gain) else gain * bottom - later.sum()
    slope, ratio = theta[na] / b0, theta[na + 2] / theta[na]
    right, left = theta[na + 1] / theta[na], theta[na + 3] / theta[na + 2]
    named = {"left": left, "right": right, "left_slope": slope * ratio, "right_slope": slope}
    named |= {"width": right - left, "slope_ratio": ratio, "gain": (b0 + later.sum()) / bottom}
    named |= {f"a{i + 1}": a[i] for i in range(na)}
    return named | {"b0": b0} | {f"b{i + 1}": later[i] for i in range(nb)}
