"""From the first samples to the state of the recursion: gathered, fitted, its information, filters run up."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.likelihood.offset import without_column
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import LocalFit, refine
from lostmotion.identify.recursive.ml_recursion import Recursion
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.identify.recursive.ml_window import LARGEST_WINDOW, Window, fit_window, is_coarse, may_begin
from lostmotion.kernels.recursive_ml import advance, drift, information, watch
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.threads import one_thread

SMALLEST_VARIANCE = 1e-24  # of scaled data: rounding
CLEAR = 3.0  # standard errors of a correlation that is none
CORRELATED = 33  # lags up to half a block of samples: what goes on for longer is a drift
_ADVANCE: Any = advance.advance  # compiled: no signature that a type checker knows


@dataclass(eq=False)
class FirstWindow:
    """Samples that are gathered until they tell enough to begin.

    Attributes
    ----------
    u, y : list of float
        Gathered samples; NaN where missing or masked.
    seen : int
        Samples seen, those included that have left the window.
    next_try : int
        Number of samples seen at which the window is fitted; 0: `start_samples`.
    integrating : bool
        Whether the last fit of the window had a process that integrates, which is not followed.
    """

    settings: Settings
    u: list[float] = field(default_factory=list)
    y: list[float] = field(default_factory=list)
    seen: int = 0
    next_try: int = 0
    integrating: bool = False

    def __post_init__(self) -> None:
        self.next_try = self.next_try or self.settings.start_samples

    def take(self, u: float, y: float, use: bool) -> Recursion | None:
        """One sample more; the recursion, if it begins with it."""
        self.u.append(u if use else math.nan)
        self.y.append(y if use else math.nan)
        self.seen += 1
        return self._begun() if self.seen >= self.next_try else None

    @one_thread
    def _begun(self) -> Recursion | None:
        waited = self.seen / self.settings.start_samples
        repeats = np.empty(ml.REPEATS_SIZE)
        y = watch.without_stuck(np.array(self.y), repeats)
        window = Window(np.array(self.u), y).plausible
        found = fit_window(window, self.settings)
        coarse = found is not None and is_coarse(found[0], window.y)
        if coarse:  # what comes again is no stuck PV, and what stays of the rounding is no colour of the noise
            window = Window(np.array(self.u), np.array(self.y)).plausible
            found = fit_window(window, self._coarsely)
        self.integrating = found is not None and found[0].chosen.integrating
        if found is not None and may_begin(found[0], waited, window.places):
            self.u, self.y = [], []
            recursion = begin(*found, self.settings, self.seen - found[1].u.size)
            if coarse:
                repeats[ml.SHARE] = watch.ROUNDED
                lighten(recursion, watch.mean_news(window.y, repeats))
            repeats[ml.LAST_Y] /= recursion.scales[1]
            recursion.memory.parts["repeats"][:] = repeats
            return recursion
        if waited >= LARGEST_WINDOW:  # keep the newer half and go on waiting
            half = len(self.u) // 2
            self.u, self.y = self.u[half:], self.y[half:]
            self.next_try = self.seen + half
        else:
            self.next_try = 2 * self.seen
        return None

    @property
    def _coarsely(self) -> Settings:
        """Settings with which a window of a coarsely rounded PV is fitted."""
        return replace(self.settings, noise="white") if self.settings.noise == "auto" else self.settings


def lighten(recursion: Recursion, share: float) -> None:
    """Leave of what a window tells the share of its samples that tell something new."""
    for name in ("ref_h", "ref_r"):
        recursion.memory.parts[name][:] *= share
    recursion.state[[ml.WEIGHT, ml.SQUARES]] *= share
    drift.agree(recursion.state, recursion.layout)
    information.newton_step(recursion.state, recursion.layout)


def begin(fit: HammersteinFit, window: Window, settings: Settings, before: int) -> Recursion:
    """Recursion at the end of `window`, which counts its samples; all of its information is in the reference."""
    good = np.isfinite(window.u) & np.isfinite(window.y)
    scales = (float(window.u[good].std()), float(window.y[good].std()))
    scaled = Window(window.u / scales[0], window.y / scales[1])
    problem, theta = scaled_fit(fit, scaled, scales)
    # Where the offset is 0, the model is linearised there: without a dead zone its valley is long and curved.
    pinned = fit.standard_errors["offset"] == 0.0
    best = refine(problem, theta, without_column(theta.size, problem.offset_at) if pinned else None)  # initial states
    state, layout = settings.tuning.allocate(settings.orders, problem.structure.noise_order)
    recursion = Recursion(settings, state, layout, scales, before)
    n = recursion.n
    remember(recursion, best, problem.evaluate(best.theta)[1])
    weight = min(problem.errors, settings.remembered)
    state[ml.WEIGHT] = weight
    state[ml.SQUARES] = max(best.cost / max(problem.errors - n, 1), SMALLEST_VARIANCE) * weight
    state[[ml.LOW, ml.HIGH]] = float(np.nanmin(scaled.u)), float(np.nanmax(scaled.u))
    layout[[ml.COUNT, ml.LEFT_AT, ml.RIGHT_AT, ml.PERIOD_FROM]] = window.u.size
    recursion.memory.parts["usual"][:] = colour_of(fit.residuals)
    drift.agree(state, layout)
    run_up(state, layout, scaled)
    information.newton_step(state, layout)
    return recursion


def colour_of(residuals: FloatArray) -> float:
    """How much more than with white errors a sum of many may vary: twice the clear positive correlations."""
    size = residuals.size
    spectrum = np.abs(np.fft.rfft(residuals - residuals.mean(), 2 * size)) ** 2
    correlations = np.fft.irfft(spectrum)[: min(CORRELATED, size)]
    if not correlations[0] > 0.0:
        return 0.0
    relative = correlations[1:] / correlations[0]
    return 2.0 * float(relative[relative > CLEAR / math.sqrt(size)].sum())


def scaled_fit(fit: HammersteinFit, scaled: Window, scales: tuple[float, float]) -> tuple[Problem, FloatArray]:
    """The fit's likelihood and parameters in units of the recursion; initial states 0."""
    chosen, values = fit.chosen, fit.parameters
    na, nb, delay, p = chosen.na, chosen.nb, chosen.delay, chosen.noise_order
    segments = scaled.segments(3 * (na + nb + delay + p) + 30)
    if not len(segments):  # the noise model has come out long: those of the fit
        segments = scaled.segments(3 * (na + nb + delay) + 40)
    family = DeadZoneFamily(float(np.nanmin(scaled.u)), float(np.nanmax(scaled.u)))
    structure = Structure(na, nb, delay, p, delay + p)
    problem = Problem(np.nan_to_num(scaled.u), np.nan_to_num(scaled.y), segments, family, structure)
    eta = np.array([values["left"] / scales[0], values["right"] / scales[0], np.log(values["slope_ratio"])])
    a, b, d = np.array(fit.linear.a), np.array(fit.linear.b), np.array(fit.noise.d)
    slope = values["right_slope"] * (scales[0] / scales[1])
    return problem, problem.pack(a, b * slope, family.project(eta), d, values["offset"] / scales[1])


def remember(recursion: Recursion, best: LocalFit, gradient: FloatArray) -> None:
    """Put theta and what the window tells of it, its initial states unknown, into the state."""
    parts, n = recursion.memory.parts, recursion.n
    shared, initial = slice(0, n), slice(n, None)
    h, theta = best.hessian, np.ascontiguousarray(best.theta[:n])
    past = h[shared, initial] @ np.linalg.pinv(h[initial, initial], hermitian=True)
    known = h[shared, shared] - past @ h[initial, shared]
    slopes = gradient[shared] - past @ gradient[initial]
    parts["theta"][:] = theta
    parts["ref_h"][:] = 0.5 * (known + known.T)
    parts["ref_r"][:] = known @ theta - slopes


def run_up(state: FloatArray, layout: IntArray, scaled: Window) -> None:
    """Bring the filters to the end of the window from rest; wait where it is too short for them to settle."""
    parts = ml.named(state, layout)
    theta, filters = parts["theta"], parts["filters"]
    na, nb1, delay, p = (int(value) for value in layout[: ml.P + 1])
    psi = np.zeros(theta.size)
    held = scaled.u[np.isfinite(scaled.u)][0]
    filters[: delay + 1] = held
    settled = 0
    for value, output in zip(scaled.u, scaled.y, strict=True):
        held = value if np.isfinite(value) else held
        settled = settled + 1 if np.isfinite(value) else 0
        _ADVANCE(held, output, theta, filters, na, nb1, delay, p, psi)
    state[ml.HELD] = held
    layout[ml.SETTLE] = max(int(advance.settling(theta, na, nb1, delay)) - settled, 0)
