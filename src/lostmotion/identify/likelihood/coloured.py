"""A fit with noise that has a zero: D(q) v = (1 - c q^-1) e.

Slow drift behind fast noise of measurement, the usual lot of a plant, is no autoregression of an order that a record
carries: its zero lies near the pole of the drift. In a closed loop what a short one leaves is tied to OP by the
controller, and moves the break points (docs/method.md, "zero of the noise").
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import cost_of_equal, per_row
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.noise_order import choose_noise, share_of_errors
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import is_hopeless, refine, settled, with_states
from lostmotion.models import NoiseModel

MOST_LAGS, SHARE = 100, 8  # of a zero as an autoregression: its order in lags, and in rows of a segment
ROUNDS = 2  # of noise and everything else by turns
SCANNED = (0.0, 0.8, 0.92, 0.97)  # of the best structure


def with_coloured_noise(fitted: Fitted, asked: Asked) -> Fitted:
    """The fit with the zero of the noise that its residual asks for, refined, where that pays."""
    if not asked.any_noise:
        return fitted
    best = fitted
    for _ in range(ROUNDS):
        zero = best.left.likeliest_zero
        trial = _recoloured(best, zero, best) if zero != 0.0 else None
        if trial is None or not per_row(trial) < per_row(best):
            break
        best = trial
    return best


def with_best_zero(fitted: Fitted, asked: Asked) -> Fitted:
    """The likeliest of the fits with zeros of all sizes: what one leaves over tells little of those far from it."""
    if not asked.any_noise:
        return fitted
    best = fitted
    for zero in SCANNED:
        trial = None if zero == fitted.problem.structure.zero else _recoloured(fitted, zero, best)
        if trial is not None and per_row(trial) < per_row(best):
            best = trial
    return best


def autoregression_like(fitted: Fitted, most: int) -> FloatArray:
    """Noise of a fit as an autoregression of at most so many lags, which rough fits have."""
    if fitted.problem.structure.zero == 0.0:
        return fitted.parts.d
    return choose_noise(fitted.output_residual(), most)


def _recoloured(fitted: Fitted, zero: float, best: Fitted) -> Fitted | None:
    """Refined with this zero, and the order that the residual asks for; None: it is the noise that it has.

    Also where it is plain that it does not come near `best`.
    """
    d = fitted.left.noise(zero)
    problem, s, parts = fitted.problem, fitted.problem.structure, fitted.parts
    if (zero, d.size) == (s.zero, s.noise_order):
        return None
    structure = Structure(s.na, s.nb, s.delay, d.size, s.delay + d.size, s.integrating, zero)
    early = share_of_errors(fitted.left.parts, zero, d) if zero else 0.0
    coloured = Problem(problem.u, problem.y, problem.segments, problem.family, structure, problem.held, early)
    basis = None if fitted.basis is None else _basis(fitted, coloured)
    packed = coloured.pack(parts.a, parts.b, parts.eta, d, parts.offset)
    begun = Fitted(coloured, replace(fitted.fit, theta=packed), basis, fitted.rivals)
    bound = cost_of_equal(begun, per_row(best))
    if is_hopeless(coloured, packed, basis, bound):
        return None
    start = settled(coloured, packed, basis)
    tied = coloured.family.needles  # whose place is sought elsewhere
    free = coloured.free_but(coloured.own, basis) if tied else basis
    return replace(begun, fit=refine(coloured, start, free, tied=tied, bound=bound))


def _basis(fitted: Fitted, problem: Problem) -> FloatArray:
    """Free directions with another noise order: those of the shared parameters, and all of noise and initial states."""
    at, shared = fitted.problem.noise_at, _shared(fitted)
    rest = problem.size - at
    return np.block([[shared, np.zeros((at, rest))], [np.zeros((rest, shared.shape[1])), np.eye(rest)]])


def as_autoregression(fitted: Fitted) -> Fitted:
    """The same fit with its noise as a long autoregression, which is held, for what knows no other noise."""
    problem, s, parts = fitted.problem, fitted.problem.structure, fitted.parts
    if s.zero == 0.0:
        return fitted
    room = int(np.diff(problem.segments, axis=1).min()) // SHARE
    d = np.array(NoiseModel(tuple(parts.d), 1.0, s.zero).autoregression(min(MOST_LAGS, room)).d)
    lags = d.size
    structure = Structure(s.na, s.nb, s.delay, lags, s.delay + lags, s.integrating)
    plain = Problem(problem.u, problem.y, problem.segments, problem.family, structure, problem.held)
    theta = plain.pack(parts.a, parts.b, parts.eta, d, parts.offset)
    shared = np.eye(problem.noise_at) if fitted.basis is None else _shared(fitted)
    initial = plain.size - plain.initial_at
    basis = np.zeros((plain.size, shared.shape[1] + initial))
    basis[: problem.noise_at, : shared.shape[1]] = shared
    basis[plain.initial_at :, shared.shape[1] :] = np.eye(initial)
    begun = refine(plain, with_states(plain, theta), basis[:, shared.shape[1] :], most_steps=2, tied=True)
    return Fitted(plain, begun, basis, fitted.rivals)


def _shared(fitted: Fitted) -> FloatArray:
    """Free directions of what is neither noise nor initial states."""
    assert fitted.basis is not None  # noqa: S101  asked before
    shared = fitted.basis[: fitted.problem.noise_at]
    return shared[:, np.any(shared != 0.0, axis=0)]
