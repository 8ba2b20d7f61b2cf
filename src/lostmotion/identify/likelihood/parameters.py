"""From the scaled parameter vector to named parameters in engineering units, with their covariance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import Scaling

SMALLEST_REST = 1e-12  # of A(1): below it the process integrates, and has no gain
CUTOFF = 1e-13  # relative eigenvalue below which a direction of the information matrix is empty
ROUNDING = 1e-5  # components of such a direction that are nothing but rounding: it is often one of initial states


@dataclass(frozen=True)
class Named:
    """Parameters in engineering units and their covariance, both in the order of `values`."""

    values: dict[str, float]
    covariance: FloatArray


def information_inverse(hessian: FloatArray, basis: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Covariance of all parameters up to the residual variance, and the directions without information (columns).

    With a `basis` only its directions are free, the others are known.
    """
    block = hessian if basis is None else basis.T @ hessian @ basis
    scale = np.sqrt(np.maximum(np.diag(block), 0.0))
    scale[scale == 0] = 1.0
    values, vectors = np.linalg.eigh(block / np.outer(scale, scale))
    seen = values > CUTOFF * values[-1]
    root = (vectors[:, seen] / np.sqrt(values[seen])) / scale[:, None]
    blind = np.where(np.abs(vectors[:, ~seen]) > ROUNDING, vectors[:, ~seen], 0.0)
    empty = blind / scale[:, None]
    if basis is not None:
        root, empty = basis @ root, basis @ empty
    return root @ root.T, empty


def name_parameters(fitted: Fitted, scaling: Scaling, gain: float | None) -> Named:
    """Named parameters by the chain rule (complex step, exact).

    Raises
    ------
    ParameterError
        The known gain has the other sign than the record, or is zero.
    """
    problem = fitted.problem
    theta = fitted.fit.theta[: problem.initial_at]
    s = problem.structure
    values, jacobian = named_values(theta, problem.family, s.na, s.nb, scaling, gain)
    if s.integrating:
        at = problem.eta_at + len(problem.family.own) if problem.family.load else None
        values, jacobian = _of_integrator(values, jacobian, theta, at, scaling, problem.family.relative)
    inverse, empty = information_inverse(fitted.fit.hessian, fitted.basis)
    covariance = jacobian @ (fitted.variance * inverse[: theta.size, : theta.size]) @ jacobian.T
    for direction in empty.T:
        own = direction[problem.eta_at :][: len(problem.family.own)]
        room = problem.family.room(fitted.actuator, own, float(np.abs(direction).max()), problem.u)
        move = jacobian @ direction[: theta.size]
        if not move.any():
            continue
        if np.isfinite(room):
            covariance += np.outer(move, move) * room**2 / 12.0  # anywhere in the gap is equally good
        else:
            unknown = np.abs(move) > 1e-6 * np.abs(move).max(initial=1e-300)
            covariance[unknown, unknown] = np.inf
    return Named(values, covariance)


def with_profiled(named: Named, profiled: dict[str, tuple[float, float]]) -> FloatArray:
    """Covariance in which parameters with a profile interval have its spread; correlations are kept where known."""
    covariance = named.covariance.copy()
    for index, name in enumerate(named.values):
        if name not in profiled:
            continue
        low, high = profiled[name]
        wanted, own = (high - low) / (2.0 * 1.96), np.sqrt(covariance[index, index])
        factor = wanted / own if np.isfinite(wanted) and np.isfinite(own) and own > 0 else 0.0
        covariance[index] = factor * np.where(np.isfinite(covariance[index]), covariance[index], 0.0)
        covariance[:, index] = covariance[index]
        covariance[index, index] = wanted**2
    return covariance


def _of_integrator(
    values: dict[str, float],
    jacobian: FloatArray,
    theta: FloatArray,
    load_at: int | None,
    scaling: Scaling,
    relative: bool,
) -> tuple[dict[str, float], FloatArray]:
    """Instead of gain and offset an integrating process has a load, in units of x."""
    names = list(values)
    kept = [index for index, name in enumerate(names) if name not in ("gain", "offset")]
    rows = [jacobian[kept]]
    result = {names[index]: values[names[index]] for index in kept}
    if load_at is not None:
        row = np.zeros((1, theta.size))
        row[0, load_at] = scaling.u_scale
        rows.append(row)
        result["load"] = scaling.u_scale * float(theta[load_at]) + (0.0 if relative else -scaling.u_centre)
    return {**result, "gain": float(np.inf)}, np.concatenate([*rows, np.zeros((1, theta.size))])


def named_values(
    theta: FloatArray, family: Family | type[Family], na: int, nb: int, scaling: Scaling, gain: float | None
) -> tuple[dict[str, float], FloatArray]:
    """Named parameters and their derivatives with respect to the scaled vector (complex step)."""
    names, values = _transform(theta, family, na, nb, scaling, gain)
    jacobian = np.empty((len(names), theta.size))
    for column in range(theta.size):
        shifted = theta.astype(complex)
        shifted[column] += 1e-30j
        _, moved = _transform(shifted, family, na, nb, scaling, gain)
        jacobian[:, column] = np.imag(moved) / 1e-30
    return dict(zip(names, np.real(values).tolist(), strict=True)), jacobian


def _transform(
    theta: npt.NDArray[Any], family: Family | type[Family], na: int, nb: int, scaling: Scaling, gain: float | None
) -> tuple[list[str], npt.NDArray[Any]]:
    """Names and values of all parameters for one scaled vector (real or complex)."""
    a, b = theta[:na], theta[na : na + nb + 1] * (scaling.y_scale / scaling.u_scale)
    rest = 1.0 + a.sum()
    product = b.sum() / (rest if abs(rest) > SMALLEST_REST else SMALLEST_REST)
    offset = scaling.y_centre + scaling.y_scale * theta[na + nb + 1]
    eta_at = na + nb + 2
    own = theta[eta_at : eta_at + len(family.own)]
    actuator, values, slope = family.named(own, scaling, product, gain)
    b, product = np.asarray(b / slope), product / slope
    if not family.relative:
        offset = offset - product * scaling.u_centre
    names = list(actuator)
    names += ["gain", "offset", *(f"a{i + 1}" for i in range(na)), *(f"b{i}" for i in range(nb + 1))]
    values += [product, offset, *a, *b]
    return names, np.array(values)
