"""Minimum of a function without derivatives, by the simplex of Nelder and Mead."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import minimize

from lostmotion.arrays import FloatArray

Cost = Callable[[FloatArray], float]
FINEST_GAIN = 0.5  # of log-likelihood: a new simplex that gains less is the last one
TURNED = -0.6  # steps of every second simplex, so that it is not the same one


def minimised(cost: Cost, point: FloatArray, steps: FloatArray, evaluations: int, rounds: int = 1) -> FloatArray:
    """Minimum (Nelder and Mead 1965), begun anew from where it ended until that gains nothing.

    Parameters
    ----------
    cost : callable
        Minus a log-likelihood: differences of some hundredths count.
    point, steps : ndarray, shape (m,)
        Start, and the edges of the first simplex.
    evaluations, rounds : int
        At most: of `cost` in a round, and rounds.

    Returns
    -------
    ndarray, shape (m,)

    Examples
    --------
    >>> minimised(lambda x: float((x[0] - 3.0) ** 2), np.zeros(1), np.ones(1), 100).round(1).tolist()
    [3.0]
    """
    best = math.inf
    for turn in range(rounds):
        simplex = np.vstack([point, point + np.diag(steps * (1.0 if turn % 2 == 0 else TURNED))])
        options: Any = {"initial_simplex": simplex, "maxfev": evaluations, "xatol": 1e-3, "fatol": 0.02}
        options["adaptive"] = True
        found: Any = minimize(cost, point, method="Nelder-Mead", options=options)
        gain, best, point = best - float(found.fun), min(best, float(found.fun)), found.x
        if gain < FINEST_GAIN:
            break
    return point
