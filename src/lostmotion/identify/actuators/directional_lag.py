"""A lag that differs with direction: a sound motor speeds up faster than it slows down.

One-step predictions on fast samples take it for backlash: PV answers a move in one direction later than in the other. A
lag of the process with the pole p and the input x,

    z(k + 1) = z(k) + (1 - p) (d + up |d| + outward |d| sign(z)),   d = x - z,

is the linear one with two inputs more, |d| and |d| sign(z), known where z is: the key-term separation of the paper,
applied to the lag. They are simulated with the parameters found, and fitted again, until these stand still.

In open loop only: behind a controller a small backlash leaves the same, and the lag would take it away.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.loads import explained_by, loaded, places_of_loads
from lostmotion.identify.likelihood.courses import Asymmetry, Loads, courses_of
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import refine, settled
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels.linear import simulate

WORTH_A_LOOK = 3.0  # of log-likelihood with all else held, of the best of all kinds: by chance one in twenty
PROMISING = 5.0  # of log-likelihood with all else held: then it is tried
WORTH = 20.0  # of it with everything refined
LARGEST = 0.9  # of the sizes together: the slower direction still moves
TURNS = 8  # of trajectory and sizes
SAME = 1e-3  # of the sizes
STEPS, STEP = 4, 1e-6  # last ones, and what a scaled parameter is moved by for their slopes
ENOUGH = 1e-9  # of the sum of squares: less is rounding
LONGEST_RISE, RISEN = 1000, 0.632  # rows in which a step response is seen to rise by a time constant


def directional(fitted: Fitted, centre: float, any_order: bool) -> Fitted:
    """The same model with a lag that differs with direction, where that pays; also with one pole, if `any_order`."""
    loads = fitted.problem.family.loads
    if loads is not None and loads.place_of(Asymmetry) is not None:
        return _along(fitted)
    if fitted.problem.structure.integrating:
        return fitted
    begun = (fitted, of_first_order(fitted) if any_order else None)
    trials = [trial for one in begun if one and (trial := _with_asymmetry(one, centre))]
    best = min(trials, key=criterion, default=fitted)
    return best if criterion(best) < criterion(fitted) - 2.0 * WORTH else fitted


def centre_of(data: ScaledData, fitted: Fitted) -> float:
    """Position in steady state where OP is 0, scaled."""
    return 0.0 if fitted.problem.family.relative else -data.scaling.u_centre / data.scaling.u_scale


def promises(fitted: Fitted, centre: float) -> bool:
    """Whether a first look at the errors finds that the lag may differ with direction."""
    look = None if fitted.problem.structure.integrating else _first_look(fitted, centre)
    return look is not None and look[2] > WORTH_A_LOOK


def _with_asymmetry(fitted: Fitted, centre: float) -> Fitted | None:
    """Refined with it; None where a first look does not promise anything."""
    look = _first_look(fitted, centre)
    return _along(loaded(fitted, fitted.problem.y, *look[:2])) if look is not None and look[2] > PROMISING else None


def _first_look(fitted: Fitted, centre: float) -> tuple[Loads, FloatArray, float] | None:
    """The two inputs, their sizes with all else held, and what these gain in log-likelihood."""
    problem, pole = fitted.problem, _dominant(fitted.parts.a)
    if pole is None:
        return None
    position = _position(problem, fitted.fit.theta)
    around = float(position.min()) < centre < float(position.max())
    event = Asymmetry(position, problem.segments, pole, centre=centre if around else None)
    added = Loads((event,), problem.u.size)
    return added, *explained_by(fitted, added.shapes)


def of_first_order(fitted: Fitted) -> Fitted | None:
    """With one pole, of the same rise: more poles may have been there to imitate the asymmetry."""
    problem, parts, s = fitted.problem, fitted.parts, fitted.problem.structure
    free = fitted.basis
    if (s.na, s.nb) == (1, 0) or (free is not None and np.any(np.count_nonzero(free, axis=0) > 1)):
        return None
    gain = float(parts.b.sum()) / (1.0 + float(parts.a.sum()))
    risen = simulate(parts.a, parts.b, 0, np.ones(LONGEST_RISE)) / gain > RISEN
    pole = float(np.exp(-1.0 / (1 + np.argmax(risen)))) if risen.any() else 1.0 - 1.0 / LONGEST_RISE
    problem = replace(problem, structure=replace(s, na=1, nb=0))
    theta = problem.pack(np.array([-pole]), np.array([gain * (1.0 - pole)]), parts.eta, parts.d, parts.offset)
    basis = None
    if free is not None:
        known = np.flatnonzero(~free.any(axis=1)) - (s.na + s.nb - 1)
        basis = problem.free_but([place for place in known.tolist() if 2 <= place < problem.initial_at])
    return replace(fitted, problem=problem, fit=refine(problem, settled(problem, theta, basis), basis), basis=basis)


def asymmetry(fitted: Fitted) -> tuple[float, float] | None:
    """How much faster the lag is up than down, and away from its centre than back; None where it is the same."""
    loads = fitted.problem.family.loads
    at = None if loads is None else loads.place_of(Asymmetry)
    if at is None:
        return None
    found = _sizes(fitted.problem, fitted.fit.theta).tolist()
    return found[0], found[1] if len(found) > 1 else 0.0


def _along(fitted: Fitted) -> Fitted:
    """With the trajectory of the valve and the lag as they now are, until both stand still; then the last steps."""
    for _ in range(TURNS):
        before = _sizes(fitted.problem, fitted.fit.theta)
        problem = _followed(fitted.problem, fitted.fit.theta)
        fitted = replace(fitted, problem=problem, fit=refine(problem, fitted.fit.theta, fitted.basis))
        if float(np.abs(_sizes(problem, fitted.fit.theta) - before).max()) < SAME:
            break
    return _exact(fitted)


def _exact(fitted: Fitted) -> Fitted:
    """Gauss-Newton with the trajectory of the lag a function of all parameters; the information is of these slopes."""
    problem, theta = fitted.problem, fitted.fit.theta
    basis = np.eye(theta.size) if fitted.basis is None else fitted.basis
    errors, cost = _errors(problem, theta), np.inf
    for _ in range(STEPS):
        cost = float(errors @ errors)
        slopes = np.array([_errors(problem, theta + STEP * way) - errors for way in basis.T]) / STEP
        inner = slopes @ slopes.T
        scale = np.sqrt(np.maximum(np.diag(inner), 1e-300))
        move = np.linalg.lstsq(inner / np.outer(scale, scale), slopes @ errors / scale, rcond=1e-12)[0] / scale
        moved = problem.project(theta - basis @ move)
        after = _errors(problem, moved) if problem.admissible(moved) else errors
        if float(after @ after) >= cost * (1.0 - ENOUGH):
            break
        theta, errors = moved, after
    problem = _followed(problem, theta)
    whole = basis @ np.linalg.pinv(basis.T @ basis)
    fit = replace(fitted.fit, theta=theta, cost=float(errors @ errors), hessian=whole @ inner @ whole.T)
    return replace(fitted, problem=problem, fit=fit)


def _errors(problem: Problem, theta: FloatArray) -> FloatArray:
    """Prediction errors with the trajectory of these parameters."""
    return np.concatenate(_followed(problem, theta).predict(theta)[1])


def _followed(problem: Problem, theta: FloatArray) -> Problem:
    """The problem with the lag simulated for these parameters."""
    loads = problem.family.loads
    at = None if loads is None else loads.place_of(Asymmetry)
    if loads is None or at is None:
        return problem
    event = loads.events[at]
    assert isinstance(event, Asymmetry)  # noqa: S101
    sizes = _sizes(problem, theta)
    sizes = sizes * min(1.0, LARGEST / max(float(np.abs(sizes).sum()), 1e-300))
    shares = dict(zip(event.names, sizes.tolist(), strict=True))
    pole = _dominant(theta[: problem.structure.na]) or event.pole
    moved = replace(event, position=_position(problem, theta), pole=pole, **shares)
    events = (*loads.events[:at], moved, *loads.events[at + 1 :])
    return replace(problem, family=problem.family.with_loads(Loads(events, loads.rows)))


def _sizes(problem: Problem, theta: FloatArray) -> FloatArray:
    """Of the asymmetry."""
    loads = problem.family.loads
    assert loads is not None  # noqa: S101
    at = loads.place_of(Asymmetry)
    assert at is not None  # noqa: S101
    return theta[places_of_loads(problem)[at]]


def _dominant(a: FloatArray) -> float | None:
    """The slowest real pole between 0 and 1."""
    poles = np.roots(np.append(1.0, a))
    real = poles[(np.abs(poles.imag) < 1e-9) & (poles.real > 0.0) & (poles.real < 1.0)].real
    return float(real.max()) if real.size else None


def _position(problem: Problem, theta: FloatArray) -> FloatArray:
    """Of the valve behind its characteristic, (n,), in units of scaled OP."""
    x, loads = np.empty(problem.u.size), problem.family.loads
    problem.family.path(theta[problem.own.start : problem.own.stop], problem.u, x)
    if loads is not None and (at := loads.bend) is not None:
        x += theta[places_of_loads(problem)[at]] @ courses_of(loads.events[at], loads.rows)
    return x
