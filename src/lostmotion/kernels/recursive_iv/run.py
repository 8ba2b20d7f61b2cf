"""Recursive estimation with key-term separation (paper, eqs 16-26, 31): one kernel, several instruments.

Regressor (eq 23, na + nb + 4 entries, then the past residuals of extended least squares):

    phi = [-y(k-1) .. -y(k-na), Xr u(k-d), -Xr, Xl u(k-d), -Xl, x(k-d-1) .. x(k-d-nb), e(k-1) .. e(k-ne)]
    theta = [a1 .. a_na, b0 mr, b0 mr br, b0 ml, b0 ml bl, b1 .. b_nb, c1 .. c_ne]

The instrument z is phi itself (least squares), phi with y replaced by the model's output, or the printed eq 20.
Between samples phi already holds the past y, x and residuals. State and layout:
:mod:`lostmotion.kernels.recursive_iv.state`.
"""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.lanes import address, dot, load, store
from lostmotion.kernels.numba_cache import njit
from lostmotion.kernels.recursive_iv import state as iv
from lostmotion.kernels.recursive_iv.spread import gather
from lostmotion.kernels.recursive_iv.update import correct, hold_if_stable, separate, separate_safely

ROUNDING = 1e-9  # of the range of u: a smaller move is that of floats


@njit(nogil=True, error_model="numpy", forceinline=True)
def take_input(state: FloatArray, layout: IntArray, u: float) -> float:
    """Put u(k) into its ring; return u(k-d)."""
    size, ring = layout[iv.PAST_U], layout[iv.U]
    now = layout[iv.NOW_U] + 1
    move = abs(u - state[ring + now - 1])
    if now >= size:
        now = 0
    least = ROUNDING * (state[iv.HIGH] - state[iv.LOW])
    if layout[iv.COUNT] > 0 and move > least:
        step = state[iv.GAP]
        rest = move if step == 0.0 else abs(move - step * math.floor(move / step + 0.5))
        if rest > least:
            state[iv.GAP] = rest
    layout[iv.NOW_U] = now
    state[ring + now] = u
    state[iv.LOW] = min(state[iv.LOW], u)
    state[iv.HIGH] = max(state[iv.HIGH], u)
    then = now - layout[iv.DELAY]
    if then < 0:
        then += size
    delayed: float = state[ring + then]
    return delayed


@njit(nogil=True, error_model="numpy", forceinline=True)
def fill(state: FloatArray, layout: IntArray, u: float, kind: int) -> int:
    """Complete the regressor with u = u(k-d) and write the instrument; return its place."""
    na, phi, pad = layout[iv.NA], layout[iv.PHI], layout[iv.PAD]
    key = phi + na
    over = 1.0 if u > state[iv.ZONE + 1] else 0.0
    under = 1.0 if u < state[iv.ZONE] else 0.0
    state[key] = over * u
    state[key + 1] = -over
    state[key + 2] = under * u
    state[key + 3] = -under
    slot = layout[iv.NOW_Z] + 1
    if slot > na:
        slot = 0
    layout[iv.NOW_Z] = slot
    z = layout[iv.Z] + slot * pad
    for i in range(0, pad, 4):
        store(state, z + i, load(state, phi + i))
    outputs = layout[iv.OUTPUTS]
    if kind == iv.MODEL_OUTPUT:
        for i in range(na):
            state[z + i] = -state[outputs + i]
    elif kind == iv.PRINTED:
        for i in range(na):
            state[z + i] = state[outputs + i]
        size, then = layout[iv.PAST_U], layout[iv.NOW_U] - layout[iv.DELAY]
        for i in range(layout[iv.N] - na):
            back = then - i
            state[z + na + i] = state[layout[iv.U] + (back + size if back < 0 else back)]
    return int(z)


@njit(nogil=True, error_model="numpy", forceinline=True)
def model_output(state: FloatArray, layout: IntArray, z: int, kind: int) -> float:
    """Output simulated with the held parameters."""
    if kind == iv.MODEL_OUTPUT:
        return dot(state, layout[iv.HELD], z, layout[iv.PAD])  # the instrument is what it needs
    na, held, phi, outputs = layout[iv.NA], layout[iv.HELD], layout[iv.PHI], layout[iv.OUTPUTS]
    value = 0.0
    for i in range(na):
        value -= state[held + i] * state[outputs + i]
    for i in range(na, na + 4 + layout[iv.NB]):
        value += state[held + i] * state[phi + i]
    return value


@njit(nogil=True, error_model="numpy", forceinline=True)
def shift(state: FloatArray, at: int, size: int, value: float) -> None:
    """Move a newest-first stretch on and put `value` in front."""
    for i in range(size - 1, 0, -1):
        state[at + i] = state[at + i - 1]
    if size > 0:
        state[at] = value


@njit(nogil=True, error_model="numpy", forceinline=True)
def remember(state: FloatArray, layout: IntArray, u: float, y: float, output: float) -> None:
    """Past values of the next regressor; u = u(k-d)."""
    na, nb, ne, phi = layout[iv.NA], layout[iv.NB], layout[iv.NE], layout[iv.PHI]
    x = 0.0
    if u > state[iv.ZONE + 1]:
        x = state[iv.ZONE + 3] * (u - state[iv.ZONE + 1])
    elif u < state[iv.ZONE]:
        x = state[iv.ZONE + 2] * (u - state[iv.ZONE])
    if ne > 0:
        shift(state, phi + na + 4 + nb, ne, y - dot(state, phi, layout[iv.THETA], layout[iv.PAD]))
    shift(state, phi, na, -y)
    shift(state, phi + na + 4, nb, x)
    shift(state, layout[iv.OUTPUTS], na, output)


@njit(nogil=True, error_model="numpy")
def keep_theta(state: FloatArray, layout: IntArray) -> None:
    """Theta after a power of 2 of samples, and that after half as many."""
    earlier, pad = layout[iv.EARLIER], layout[iv.PAD]
    for i in range(pad):
        state[earlier + i] = state[earlier + pad + i]
        state[earlier + pad + i] = state[layout[iv.THETA] + i]


@njit(nogil=True, error_model="numpy", forceinline=True)
def advance(state: FloatArray, layout: IntArray, u: float, y: float) -> float:
    """One sample on the addresses of state and layout; return the prediction error."""
    count, lam = layout[iv.COUNT], state[iv.FORGETTING]
    started = count >= state[iv.START]
    delayed = take_input(state, layout, u)
    kind = layout[iv.KIND] if started else iv.LEAST_SQUARES
    z = fill(state, layout, delayed, kind)
    error = y - dot(state, layout[iv.PHI], layout[iv.THETA], layout[iv.PAD])
    kept = correct(state, layout, z, error) if count >= layout[iv.DELAY] else 0.0
    if kept > 0.0:
        if layout[iv.CONSTRAINED] == 1:
            separate_safely(state, layout)
        else:
            separate(state, layout)
        hold_if_stable(state, layout)
        state[iv.TOTAL] = kept * state[iv.TOTAL] + 1.0
        state[iv.TOTAL_SQUARED] = kept * kept * state[iv.TOTAL_SQUARED] + 1.0
    output = model_output(state, layout, z, kind)
    if started:
        gather(state, layout, kept if kept > 0.0 else lam, y - output, error)
    remember(state, layout, delayed, y, output)
    if count + 1 >= state[iv.CONSTANT_FOR]:
        share = state[iv.CONSTANT_FORGETTING]
        state[iv.FORGETTING] = share * lam + 1.0 - share
    layout[iv.COUNT] = count + 1
    if (count + 1) & count == 0:
        keep_theta(state, layout)
    return error


@njit(nogil=True, error_model="numpy")
def step(state: FloatArray, layout: IntArray, u: float, y: float) -> float:
    """One sample; return the prediction error."""
    return advance(address(state), address(layout), u, y)


@njit(nogil=True, error_model="numpy")
def run(state: FloatArray, layout: IntArray, u: FloatArray, y: FloatArray, every: int, trace: FloatArray) -> FloatArray:
    """All samples; every `every`-th leaves [theta, zone] in a row of `trace`. Return the prediction errors."""
    at_state, at_layout = address(state), address(layout)
    errors = np.empty(u.size)
    n, theta = layout[iv.N], layout[iv.THETA]
    row, due = 0, every
    for k in range(u.size):
        errors[k] = advance(at_state, at_layout, u[k], y[k])
        due -= 1
        if due == 0:
            for i in range(n):
                trace[row, i] = state[theta + i]
            for i in range(4):
                trace[row, n + i] = state[iv.ZONE + i]
            row, due = row + 1, every
    return errors
