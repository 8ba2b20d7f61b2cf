"""Linear part: stability of A, and the filter B/A with delay."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import ComplexArray, FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit

FEW = 3  # poles that are found without an eigenvalue problem
MOST_HALVES = 200  # of an interval: a bound that Newton steps do not come near
GONE = 1e-12  # a pole of this size is none
REAL = 1e-9  # radians: nearer to the real axis a pole is real


@njit(nogil=True, error_model="numpy")
def inside_circle(poly: FloatArray, first: int, n: int) -> bool:
    """Whether all roots of z^n + poly[first] z^(n-1) + .. lie inside the unit circle (step-down, in place)."""
    last = first + n - 1
    for order in range(n, 0, -1):
        reflection = poly[last]
        if not abs(reflection) < 1.0:
            return False
        inverse = 1.0 / (1.0 - reflection * reflection)
        half = (order - 1) // 2
        for i in range(first, first + half):
            j = first + last - 1 - i
            upper = (poly[i] - reflection * poly[j]) * inverse
            poly[j] = (poly[j] - reflection * poly[i]) * inverse
            poly[i] = upper
        if order % 2 == 0:
            poly[first + half] = (poly[first + half] - reflection * poly[first + half]) * inverse
        last -= 1
    return True


@njit(nogil=True)
def three_inside_circle(a1: float, a2: float, a3: float) -> bool:
    """Whether all roots of z^3 + a1 z^2 + a2 z + a3 lie inside the unit circle (Jury's criterion)."""
    return abs(a3) < 1.0 and abs(a1 + a3) < 1.0 + a2 and abs(a2 - a1 * a3) < 1.0 - a3 * a3


@njit()
def is_stable(a: FloatArray, radius: float) -> bool:
    """Whether all roots of z^n + a[0] z^(n-1) + .. + a[n-1] lie inside `radius`."""
    poly = a.copy()
    scale = 1.0
    for i in range(a.size):
        scale *= radius
        poly[i] /= scale
    return inside_circle(poly, 0, poly.size)


@njit()
def few_poles(a: FloatArray) -> ComplexArray:
    """Roots of z^n + a[0] z^(n-1) + .. + a[n-1] for n up to FEW."""
    poles = np.zeros(a.size, np.complex128)
    if a.size == 0:
        return poles
    rest, last = a, a.size - 1
    if a.size == 3:
        real = _real_root(a[0], a[1], a[2])
        second = a[1] + real * (a[0] + real)
        rest, poles[2] = np.array([a[0] + real, second]), real
    if last == 0:
        poles[0] = -rest[0]
        return poles
    half = -0.5 * rest[0]
    root = half * half - rest[1]
    if root < 0.0:
        poles[0], poles[1] = complex(half, np.sqrt(-root)), complex(half, -np.sqrt(-root))
    else:
        far = half + np.sqrt(root) if half > 0.0 else half - np.sqrt(root)
        poles[0], poles[1] = far, rest[1] / far if far != 0.0 else 0.0
    return poles


@njit()
def _real_root(a1: float, a2: float, a3: float) -> float:
    """One of z^3 + a1 z^2 + a2 z + a3: steps of Newton, halves of the interval where they leave it."""
    high = 1.0 + max(abs(a1), abs(a2), abs(a3))
    low, z = -high, -a1 / 3.0
    for _ in range(MOST_HALVES):
        value, slope = ((z + a1) * z + a2) * z + a3, (3.0 * z + 2.0 * a1) * z + a2
        if value == 0.0:
            break
        low, high = (low, z) if value > 0.0 else (z, high)
        moved = z - value / slope if slope != 0.0 else low
        if not low < moved < high:
            moved = 0.5 * (low + high)
        if moved == z:
            break
        z = moved
    return z


@njit()
def pole_rings(pole: complex, least_damping: float, slowest: float) -> bool:
    """Whether a pole is one of a pair with less damping than this, or negative and slower than `slowest`."""
    size, angle = abs(pole), abs(np.arctan2(pole.imag, pole.real))
    if not size > GONE:
        return False
    decay = -np.log(size)
    if angle > np.pi - REAL and pole.imag >= 0.0 and size > slowest:
        return True
    return bool(angle >= REAL and decay < least_damping * np.hypot(decay, angle))


@njit()
def rings(a: FloatArray, least_damping: float, slowest: float) -> bool:
    """Whether any of up to FEW poles does."""
    found = False
    for pole in few_poles(a):
        found = found or pole_rings(pole, least_damping, slowest)
    return found


@njit()
def simulate(a: FloatArray, b: FloatArray, delay: int, x: FloatArray) -> FloatArray:
    """Output of q^-delay B/A from rest, for inputs x (n,)."""
    y = np.empty(x.size)
    for k in range(x.size):
        value = 0.0
        for i in range(b.size):
            j = k - delay - i
            if j >= 0:
                value += b[i] * x[j]
        for i in range(a.size):
            j = k - 1 - i
            if j >= 0:
                value -= a[i] * y[j]
        y[k] = value
    return y


@njit()
def step_lasts(a: FloatArray, b: FloatArray, late: IntArray, least: float, most_back: float, direction: int) -> bool:
    """Whether the response of B/A to a step is there to stay, at every number of samples in `late` (ascending).

    Over the later half more than `least` of its peak is there, it went the other way by `most_back` of the peak at
    most, and its sign is not that of `direction`.
    """
    few, recent = a.size <= FEW, np.zeros(max(a.size, 1))
    a1, a2 = a[0] if a.size > 0 else 0.0, a[1] if a.size > 1 else 0.0
    a3 = a[2] if a.size > 2 else 0.0
    y1 = y2 = y3 = 0.0
    low = high = drive = total = before = 0.0
    at = 0
    for k in range(late[-1]):
        if k < b.size:
            drive += b[k]
        if few:  # in registers
            value = (drive - a3 * y3 - a2 * y2) - a1 * y1
            y3, y2, y1 = y2, y1, value
        else:
            value = drive
            for i in range(a.size):
                value -= a[i] * recent[i]
            for i in range(a.size - 1, 0, -1):
                recent[i] = recent[i - 1]
            recent[0] = value
        low, high, total = min(low, value), max(high, value), total + value
        if k + 1 == late[at] // 2:
            before = total
        if k + 1 == late[at]:
            left = (total - before) / (late[at] - late[at] // 2)
            ahead, back = (high, -low) if left > 0.0 else (-low, high)
            if not abs(left) > least * ahead or back > most_back * ahead or left * direction > 0.0:
                return False
            at += 1
    return True


@njit()
def is_allowed(
    a: FloatArray,
    b: FloatArray,
    integrating: bool,
    radius: float,
    held: bool,
    late: IntArray,
    least: float,
    most_back: float,
    direction: int,
) -> bool:
    """Whether A, without its integrator where it has one, is stable, and the step lasts where the process is held."""
    rest, total = a, 0.0
    if integrating:  # A / (1 - q^-1)
        rest = np.empty(max(a.size - 1, 0))
        for i in range(rest.size):
            total += a[i]
            rest[i] = 1.0 + total
    return is_stable(rest, radius) and (not held or step_lasts(a, b, late, least, most_back, direction))


@njit()
def best_lasting(
    rss: FloatArray,
    chosen: IntArray,
    polynomials: FloatArray,
    b: FloatArray,
    late: IntArray,
    least: float,
    most_back: float,
    direction: int,
    tries: int,
    best: IntArray,
) -> None:
    """For every column j the index i of `chosen` with the smallest rss[i, j] whose b[i, j] / polynomials[i] lasts.

    `tries` at most are looked at, best first; -1 where none of them lasts. `rss` is overwritten; fills best (columns,).
    """
    for column in range(rss.shape[1]):
        best[column] = -1
        for _ in range(min(tries, chosen.size)):
            smallest = chosen[0]
            for index in chosen:
                if rss[index, column] < rss[smallest, column]:
                    smallest = index
            if step_lasts(polynomials[smallest], b[smallest, column], late, least, most_back, direction):
                best[column] = smallest
                break
            rss[smallest, column] = np.inf
