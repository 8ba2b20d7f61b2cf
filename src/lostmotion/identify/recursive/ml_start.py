"""From a first window to the state of the recursion: batch fit, its information, filters run up to the present."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import DataError, Status
from lostmotion.identify.actuators.dead_zone import LARGEST_SLOPE_RATIO, DeadZoneFamily
from lostmotion.identify.estimate import identify
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.kernels import recursive_ml as kernel
from lostmotion.records import LoopRecord

BLOCK, LARGEST_RING = 64, 16
FEWEST_BLOCKS = 8
OUTLIER = 6.0  # median deviations beyond which a residual of the start window is drawn in
SMALLEST_VARIANCE = 1e-24  # of scaled data: rounding
GOOD = (Status.OK, Status.MISFIT, Status.COLOURED)
CLEAR_WIDTH, CLEAR_RATIO = 0.1, 0.3  # relative standard errors with which a first window may begin
_ADVANCE: Any = kernel.advance


@dataclass(frozen=True)
class Window:
    """Samples of the start, NaN where missing or masked; u and y in engineering units."""

    u: FloatArray
    y: FloatArray

    def segments(self, shortest: int) -> npt.NDArray[np.int64]:
        """Start and stop of the stretches without a missing sample."""
        good = np.concatenate([[False], np.isfinite(self.u) & np.isfinite(self.y), [False]])
        edges = np.flatnonzero(np.diff(good.astype(np.int8)))
        pairs = edges.reshape(-1, 2)
        return np.asarray(pairs[pairs[:, 1] - pairs[:, 0] >= shortest])


def fit_window(
    window: Window, orders: tuple[int, int, int], noise: str | int, offset: str, dt: float
) -> HammersteinFit | None:
    """Batch fit of a start window with bounded influence of outliers; None where nothing can be fitted."""
    na, nb, delay = orders
    segments = window.segments(3 * (na + nb + delay + (noise if isinstance(noise, int) else 0)) + 40)
    if not len(segments):
        return None
    try:
        fit = _fit(window.u, window.y, segments, orders, noise, offset, dt)
        drawn = _drawn_in(fit, window.y, segments)
        return fit if drawn is None else _fit(window.u, drawn, segments, orders, noise, offset, dt)
    except (DataError, np.linalg.LinAlgError):  # constant, or nearly: no information yet
        return None


def _fit(
    u: FloatArray,
    y: FloatArray,
    segments: npt.NDArray[np.int64],
    orders: tuple[int, int, int],
    noise: str | int,
    offset: str,
    dt: float,
) -> HammersteinFit:
    records = [LoopRecord(op=u[start:stop], pv=y[start:stop], dt=dt) for start, stop in segments]
    return identify(records, orders=orders, noise=noise, offset=offset, raw=True)


def is_clear(fit: HammersteinFit) -> bool:
    """Whether the dead zone is known so well that the fit is hardly a wrong maximum (docs/online.md, false events)."""
    errors, values = fit.standard_errors, fit.parameters
    wide = errors["width"] < CLEAR_WIDTH * values["width"]
    return bool(wide and errors["slope_ratio"] < CLEAR_RATIO * values["slope_ratio"])


def is_anchored(fit: HammersteinFit) -> bool:
    """Whether the static gain is known at all.

    Where it is not, poles stand next to 1, and what was linearised there counts as certainty for good.
    """
    return bool(fit.standard_errors["gain"] < abs(fit.parameters["gain"]))


def _drawn_in(fit: HammersteinFit, y: FloatArray, segments: npt.NDArray[np.int64]) -> FloatArray | None:
    """The same y with outliers drawn in to what still passes for noise; None where there are none."""
    errors = fit.residuals
    spread = 1.4826 * float(np.median(np.abs(errors - np.median(errors))))
    if spread == 0.0 or not np.any(np.abs(errors) > OUTLIER * spread):
        return None
    skipped = fit.chosen.delay + fit.chosen.noise_order
    result, at = y.copy(), 0
    for start, stop in segments:
        size = stop - start - skipped
        e = errors[at : at + size]
        result[start + skipped : stop] -= e - np.clip(e, -OUTLIER * spread, OUTLIER * spread)
        at += size
    return result


@dataclass(frozen=True)
class Tuning:
    """How the recursion forgets, bounds and tests."""

    forgetting: float
    clip: float
    threshold: float
    offset: str

    @property
    def memory(self) -> tuple[int, int, float]:
        """Samples of a block, blocks of the ring, and what the reference forgets per block.

        The memory of 1 / (1 - forgetting) samples is shared by the ring, at most half of it, and the reference.
        """
        if self.forgetting == 1.0:
            return BLOCK, LARGEST_RING, 0.0
        memory = 1.0 / (1.0 - self.forgetting)
        ring = min(0.5 * memory, BLOCK * LARGEST_RING)
        block = int(np.clip(ring / FEWEST_BLOCKS, 4, BLOCK))
        blocks = max(int(ring / block), 2)
        return block, blocks, float(1.0 - (1.0 - 1.0 / (memory - block * blocks)) ** block)


def allocate(na: int, nb: int, delay: int, p: int, tuning: Tuning) -> tuple[FloatArray, IntArray]:
    """Empty state and its layout."""
    n, nx = na + nb + 5 + p, max(na, nb + 1)
    block, ring, tail = tuning.memory
    filters = delay + 1 + 4 * nx + na + p + nb + 1 + na + 5 * p
    layout = np.zeros(kernel.LAYOUT_SIZE, dtype=np.int64)
    layout[: kernel.FILTERS + 1] = na, nb + 1, delay, p, n, block, ring, filters
    square = n * n
    sizes = {
        kernel.THETA: n, kernel.SHOWN: n, kernel.FILTER: filters, kernel.REF_H: square, kernel.REF_R: n,
        kernel.SUM_H: square, kernel.SUM_G: n, kernel.RING_H: ring * square, kernel.RING_R: ring * n,
        kernel.RING_F: ring * filters, kernel.RING_S: 2 * ring, kernel.U: ring * block, kernel.Y: ring * block,
        kernel.USED: ring * block, kernel.TOTAL_H: square, kernel.TOTAL_R: n, kernel.ROOT: square,
        kernel.INVERSE: square, kernel.PERIOD_H: square, kernel.PERIOD_R: n, kernel.WORK: square,
    }  # fmt: skip
    at = int(kernel.HEAD)
    for name, size in sizes.items():
        layout[name] = at
        at += size
    layout[kernel.SIZE] = at
    state = np.zeros(at)
    state[kernel.TAIL] = tail
    state[kernel.KEEP] = tuning.forgetting
    state[kernel.CLIP] = tuning.clip
    state[kernel.THRESHOLD] = tuning.threshold
    state[kernel.ZERO] = {"free": np.nan, "auto": 0.0, "zero": 1.0}[tuning.offset]
    state[kernel.RATIO_LIMIT] = np.log(LARGEST_SLOPE_RATIO)
    layout[kernel.TEST_AFTER] = block * ring // 2
    layout[kernel.REFIT_AT] = np.iinfo(np.int64).max
    return state, layout


def start(fit: HammersteinFit, window: Window, scales: tuple[float, float], tuning: Tuning) -> tuple[Any, ...]:
    """State and layout at the end of `window`, all of whose information is in the reference."""
    chosen = fit.chosen
    na, nb, delay, p = chosen.na, chosen.nb, chosen.delay, chosen.noise_order
    u, y = window.u / scales[0], window.y / scales[1]
    segments = window.segments(3 * (na + nb + delay + p) + 30)
    if not len(segments):  # the noise model has come out long: those of the fit
        segments = window.segments(3 * (na + nb + delay) + 40)
    family = DeadZoneFamily(float(np.nanmin(u)), float(np.nanmax(u)))
    problem = Problem(np.nan_to_num(u), np.nan_to_num(y), segments, family, Structure(na, nb, delay, p, delay + p))
    values, product = fit.parameters, scales[0] / scales[1]
    eta = np.array([values["left"] / scales[0], values["right"] / scales[0], np.log(values["slope_ratio"])])
    slope = values["right_slope"] * product
    theta = problem.pack(
        np.array(fit.linear.a),
        np.array(fit.linear.b) * slope,
        family.project(eta),
        np.array(fit.noise.d),
        values["offset"] / scales[1],
    )
    # Where the offset is 0, the model is linearised there: without a dead zone its valley is long and curved.
    pinned = fit.standard_errors["offset"] == 0.0
    basis = np.delete(np.eye(theta.size), problem.offset_at, axis=1) if pinned else None
    best = refine(problem, theta, basis)  # initial states
    state, layout = allocate(na, nb, delay, p, tuning)
    n = int(layout[kernel.N])
    shared, initial = slice(0, n), slice(n, None)
    h, theta = best.hessian, np.ascontiguousarray(best.theta[:n])
    nuisance = np.linalg.pinv(h[initial, initial], hermitian=True)
    gradient = problem.evaluate(best.theta)[1]
    past = h[shared, initial] @ nuisance
    information = h[shared, shared] - past @ h[initial, shared]
    slopes = gradient[shared] - past @ gradient[initial]
    _put(state, layout, kernel.THETA, theta)
    _put(state, layout, kernel.REF_H, 0.5 * (information + information.T))
    _put(state, layout, kernel.REF_R, information @ theta - slopes)
    weight = min(problem.errors, 1.0 / max(1.0 - tuning.forgetting, 1e-12))
    state[kernel.WEIGHT] = weight
    state[kernel.SQUARES] = max(best.cost / max(problem.errors - n, 1), SMALLEST_VARIANCE) * weight
    state[kernel.LOW], state[kernel.HIGH] = family.low, family.high
    for name in (kernel.COUNT, kernel.LEFT_AT, kernel.RIGHT_AT, kernel.PERIOD_FROM):
        layout[name] = u.size
    layout[kernel.SINCE] = 0
    _run_up(state, layout, u, y)
    kernel.newton_step(state, layout)
    return state, layout


def _run_up(state: FloatArray, layout: IntArray, u: FloatArray, y: FloatArray) -> None:
    """Bring the filters to the end of the window from rest; wait where it is too short for them to settle."""
    theta = state[layout[kernel.THETA] :][: layout[kernel.N]]
    filters = state[layout[kernel.FILTER] :][: layout[kernel.FILTERS]]
    na, nb1, delay, p = (int(value) for value in layout[: kernel.P + 1])
    psi = np.zeros(theta.size)
    held = u[np.isfinite(u)][0]
    filters[: delay + 1] = held
    settled = 0
    needed = int(kernel.settling(theta, layout))
    for value, output in zip(u, y, strict=True):
        held = value if np.isfinite(value) else held
        settled = settled + 1 if np.isfinite(value) else 0
        _ADVANCE(held, output, theta, filters, na, nb1, delay, p, psi)
    state[kernel.HELD] = held
    layout[kernel.SETTLE] = max(needed - settled, 0)


def _put(state: FloatArray, layout: IntArray, name: int, values: FloatArray) -> None:
    flat = np.ravel(values)
    state[layout[name] : layout[name] + flat.size] = flat
