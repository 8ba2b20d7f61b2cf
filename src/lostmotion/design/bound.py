"""Cramer-Rao bound of a test or a record by parameter name, from rest and in either loop."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.design.design_criterion import Z95
from lostmotion.design.simulated_plant import Plant
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.parameters import named_values
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.scaled import Scaling

NAMES = ("left", "right", "width", "slope_ratio", "gain")
SEED_STEP = 100_000  # between realisations, so that plants and realisations do not share one
LOOP_SEEDS = 6  # noise realisations over which the information in closed loop is averaged
RIDGE = 1e-13  # relative
BLIND, HOPELESS = 1e4, 10.0  # deviations before the test, and from which on it has told nothing, in widths


def half_widths(
    plant: Plant,
    u: FloatArray,
    y: FloatArray | None,
    segments: IntArray | None = None,
) -> dict[str, float]:
    """95 % half-widths that an efficient estimator reaches with OP u (n,); PV y (n,) in closed loop.

    The same figures as :func:`lostmotion.evaluate.cramer_rao` for a start at x = 0; infinite where the data are
    blind. `segments` (s, 2) are pieces of a record, whose initial states are taken from y.
    """
    problem = plant.problem(u, y, segments)
    theta = plant.theta if segments is None else np.resize(plant.theta, problem.size)
    if segments is not None:
        theta[problem.initial_at :] = 0.0
        theta = theta if y is None else _with_initial_states(problem, theta)
    _, _, hessian = problem.evaluate(theta)
    information = hessian / plant.noise.variance
    if y is None and plant.noise.order:  # independent of the rest, any positive block gives the same bound
        at = slice(problem.noise_at, problem.initial_at)
        information[at, :] = 0.0
        information[:, at] = 0.0
        information[at, at] = np.eye(plant.noise.order) * problem.errors
    return _by_name(plant, problem, theta, information)


def _by_name(plant: Plant, problem: Problem, theta: FloatArray, information: FloatArray) -> dict[str, float]:
    """Half-widths by the chain rule.

    A prior that is out of all proportion marks what the data are blind to: it is never as narrow as that.
    """
    s = problem.structure
    shared = theta[: problem.initial_at]
    values, jacobian = named_values(shared, DeadZoneFamily, s.na, s.nb, Scaling(0, 1, 0, 1), None)
    vague = np.array([BLIND * plant.zone.width, BLIND * plant.zone.width, BLIND])
    at = np.arange(problem.eta_at, problem.eta_at + 3)
    information[at, at] += vague**-2.0
    basis = np.eye(theta.size) if problem.basis is None else problem.basis
    block = basis.T @ information @ basis
    scale = np.sqrt(np.diag(block))
    scale[scale == 0] = 1.0
    block = block / np.outer(scale, scale)
    block[np.diag_indices_from(block)] += RIDGE
    found = {}
    for row, name in enumerate(values):
        if name in NAMES and not (plant.integrating and name == "gain"):
            part = (jacobian[row] @ basis[: shared.size]) / scale
            deviation = float(np.sqrt(max(float(part @ np.linalg.solve(block, part)), 0.0)))
            unit = plant.zone.width if name in ("left", "right", "width") else max(abs(values[name]), 1e-300)
            found[name] = Z95 * deviation if deviation < HOPELESS * unit else float(np.inf)
    return found


def _with_initial_states(problem: Problem, theta: FloatArray) -> FloatArray:
    """`theta` with the initial states that fit y best: the errors are linear in them."""
    _, gradient, hessian = problem.evaluate(theta)
    at = slice(problem.initial_at, problem.size)
    result = theta.copy()
    result[at] -= np.linalg.lstsq(hessian[at, at], gradient[at], rcond=1e-10)[0]
    return result


def expected(plant: Plant, signal: FloatArray, seeds: int = LOOP_SEEDS) -> dict[str, float]:
    """95 % half-widths of a planned test; in closed loop the root mean square over noise realisations."""
    if plant.controller is None:
        return half_widths(plant, signal, None)
    runs = [half_widths(plant, *plant.run(signal, plant.seed + SEED_STEP * seed)) for seed in range(seeds)]
    return {name: float(np.sqrt(np.mean([run[name] ** 2 for run in runs]))) for name in runs[0]}
