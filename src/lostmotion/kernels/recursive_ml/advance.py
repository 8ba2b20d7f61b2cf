"""One sample through the filters that give the prediction error and its gradient; how long they remember."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

SETTLED = 1e-3  # what is left of an unknown state when it no longer matters
LONGEST_SETTLING = 5000  # samples: nearly an integrator, which would never be waited for


@njit(nogil=True)
def advance(
    u: float, y: float, theta: FloatArray, filters: FloatArray, na: int, nb1: int, delay: int, p: int, psi: FloatArray
) -> float:
    """One sample through all filters; fill `psi` (n,), return the prediction error (NaN without y).

    `filters`: newest first, u (delay+1), X = (1/A) x (nx), (1/A) dx/deta (3 nx), W = -(1/A) z (na), v (p), D X (nb1),
    D W (na), then the last p of X, W and the three E = (B/A) dx/deta.
    """
    nx = max(na, nb1)
    at_x = delay + 1
    at_v = at_x + nx
    at_w = at_v + 3 * nx
    at_r = at_w + na  # noise_at
    at_xd = at_r + p
    at_wd = at_xd + nb1
    at_p = at_wd + na
    eta = na + nb1 + 1
    for i in range(delay, 0, -1):
        filters[i] = filters[i - 1]
    filters[0] = u
    delayed = filters[delay]
    ratio = np.exp(theta[eta + 2])
    x, x_left, x_right, x_ratio = 0.0, 0.0, 0.0, 0.0
    if delayed > theta[eta + 1]:
        x, x_right = delayed - theta[eta + 1], -1.0
    elif delayed < theta[eta]:
        x, x_left = ratio * (delayed - theta[eta]), -ratio
        x_ratio = x
    v1, v2 = at_v + nx, at_v + 2 * nx
    for i in range(na):
        a = theta[i]
        x -= a * filters[at_x + i]
        x_left -= a * filters[at_v + i]
        x_right -= a * filters[v1 + i]
        x_ratio -= a * filters[v2 + i]
    for i in range(4 * nx - 1, 0, -1):  # the four stretches lie one behind the other; their heads are overwritten
        filters[at_x + i] = filters[at_x + i - 1]
    filters[at_x], filters[at_v], filters[v1], filters[v2] = x, x_left, x_right, x_ratio
    z, e_left, e_right, e_ratio = 0.0, 0.0, 0.0, 0.0
    for i in range(nb1):
        b = theta[na + i]
        z += b * filters[at_x + i]
        e_left += b * filters[at_v + i]
        e_right += b * filters[v1 + i]
        e_ratio += b * filters[v2 + i]
    w = -z
    for i in range(na):
        psi[i] = filters[at_wd + i]
        w -= theta[i] * filters[at_w + i]
    v = y - theta[na + nb1] - z
    error = v
    x_d, w_d, d_sum = x, w, 1.0
    for j in range(p):
        d = theta[eta + 3 + j]
        error += d * filters[at_r + j]
        psi[eta + 3 + j] = -filters[at_r + j]
        d_sum += d
        x_d += d * filters[at_p + j]
        w_d += d * filters[at_p + p + j]
    known_left, known_right, known_ratio = e_left, e_right, e_ratio
    for j in range(p):
        d = theta[eta + 3 + j]
        e_left += d * filters[at_p + 2 * p + j]
        e_right += d * filters[at_p + 3 * p + j]
        e_ratio += d * filters[at_p + 4 * p + j]
    if p > 0:
        if np.isnan(v):
            v = 0.0
            for j in range(p):
                v -= theta[eta + 3 + j] * filters[at_r + j]
        for i in range(at_r + p - 1, at_r, -1):
            filters[i] = filters[i - 1]
        filters[at_r] = v
        for i in range(at_p + 5 * p - 1, at_p, -1):
            filters[i] = filters[i - 1]
        filters[at_p], filters[at_p + p], filters[at_p + 2 * p] = x, w, known_left
        filters[at_p + 3 * p], filters[at_p + 4 * p] = known_right, known_ratio
    for i in range(nb1 - 1, 0, -1):
        filters[at_xd + i] = filters[at_xd + i - 1]
    filters[at_xd] = x_d
    for i in range(na - 1, 0, -1):
        filters[at_w + i] = filters[at_w + i - 1]
        filters[at_wd + i] = filters[at_wd + i - 1]
    if na > 0:
        filters[at_w], filters[at_wd] = w, w_d
    for i in range(nb1):
        psi[na + i] = filters[at_xd + i]
    psi[na + nb1] = d_sum
    psi[eta], psi[eta + 1], psi[eta + 2] = e_left, e_right, e_ratio
    return float(error)


@njit(nogil=True, forceinline=True)
def noise_at(na: int, nb1: int, delay: int) -> int:
    """Place of the newest v among the filters: an outlier is taken out of it, being no noise that goes on."""
    return int(delay + 1 + 4 * max(na, nb1) + na)


@njit(nogil=True)
def forget_zone(filters: FloatArray, na: int, nb1: int, delay: int, p: int) -> None:
    """Zero what the filters know of the actuator's derivatives: new break points have not acted before."""
    nx = max(na, nb1)
    filters[delay + 1 + nx : delay + 1 + 4 * nx] = 0.0
    filters[filters.size - 3 * p :] = 0.0


@njit(nogil=True)
def settling_time(a: FloatArray) -> int:
    """Samples until a wrong initial state of A has faded to SETTLED, LONGEST_SETTLING at most."""
    n = a.size
    if n == 0:
        return 0
    companion = np.zeros((n, n))
    for i in range(n):
        companion[0, i] = -a[i]
        if i > 0:
            companion[i, i - 1] = 1.0
    power = companion
    samples = 1
    while samples < LONGEST_SETTLING:
        if np.abs(power).max() < SETTLED:
            break
        power = np.dot(power, power)
        samples *= 2
    return min(samples, LONGEST_SETTLING)


@njit(nogil=True)
def settling(theta: FloatArray, na: int, nb1: int, delay: int) -> int:
    """Samples until what is not known about the command no longer matters."""
    return int(settling_time(theta[:na]) + delay + nb1)
