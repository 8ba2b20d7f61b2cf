"""Likelihood of a measured position, given the command: a positioner that lags, holds within a band and catches up.

The command v, behind a delay and a first-order lag, and the position x differ by e = v - c - x. The position holds
while abs(e) <= h, half of the full dead band. Beyond it the position moves until e = r h is left: r = 1 is a play,
r = 0 a positioner that catches up completely. It moves no faster than a rate, and may approach its target with a lag.

The measured position y is x with white noise. Each sample is one step of a filter over three hypotheses (hold, move
up, move down) and a rare fourth, a move that the command does not explain; they are merged into one mean and variance
after each sample (generalised pseudo-Bayes of order 1; Bar-Shalom, Li and Kirubarajan, "Estimation with Applications to
Tracking and Navigation", 2001, section 11.6.5). So one late slip costs one sample and no more, where a simulation from
the first row would lose step.
"""

from __future__ import annotations

import math

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels.numba_cache import njit

OFFSET, HALF, REST, DELAY, LAG, APPROACH, RATE, NOISE, THRESHOLD_SCATTER, LANDING_SCATTER = range(10)
PARAMETERS = 10
UNEXPLAINED = 1e-3  # prior probability of a move that the command does not explain
NEVER = 2e-3  # least probability of a hypothesis: one hold beyond the band must not outweigh a record
ARRIVED = 0.05  # of the half band, or one noise: nearer than this the position has reached its target


@njit()
def command(u: FloatArray, delay: float, lag: float, line: bool, parts: int, v: FloatArray) -> None:
    """Fill `v` (n * parts,) with the command behind a delay and a first-order lag, both in samples, `parts` a sample.

    Without delay the interval before row k belongs to u(k): the command goes in a straight `line` from u(k - 1), or is
    u(k) from its beginning on; a controller whose new OP is recorded before it acts has a delay of one sample.
    """
    keep = math.exp(-1.0 / (lag * parts)) if lag > 1e-6 else 0.0
    state, last = u[0], u.size - 1
    for k in range(u.size):
        for part in range(parts):
            at = k + (part + 1.0) / parts - delay - (1.0 if line else 1e-9)
            below = math.floor(at)
            share = at - below
            row = min(max(int(below), 0), last)
            value = u[row]
            if line:
                value += share * (u[min(max(int(below) + 1, 0), last)] - u[row])
            if np.isfinite(value):
                state = value if not np.isfinite(state) else keep * state + (1.0 - keep) * value
            v[k * parts + part] = state


@njit()
def follow(
    v: FloatArray,
    y: FloatArray,
    fresh: FloatArray,
    half: float,
    offset: float,
    approach: float,
    rate: float,
    parts: int,
    x: FloatArray,
) -> None:
    """Fill `x` (n,) with the position of a play of half width `half` behind `v` (n * parts,) of :func:`command`.

    Behind the play the position approaches its target by the share `approach` in each part of a sample, and by no more
    than `rate` in it. It begins at the measured y (n,), and again where `fresh` is 1.
    """
    position, target, started = 0.0, 0.0, False
    for k in range(y.size):
        if not started or fresh[k] == 1.0:
            started = np.isfinite(y[k])
            goal = v[(k + 1) * parts - 1] - offset
            position = y[k]
            target = min(max(position, goal - half), goal + half)
            x[k] = position
            continue
        for part in range(parts):
            goal = v[k * parts + part] - offset
            target = min(max(target, goal - half), goal + half)
            position += min(max(approach * (target - position), -rate), rate)
        x[k] = position


@njit()
def holds(y: FloatArray, window: float, fresh: FloatArray) -> FloatArray:
    """Rows in which the position holds, shape (holds, 3): first, behind the last, mean; none wider than `window`."""
    found = np.empty((y.size, 3))
    count, k = 0, 0
    while k < y.size:
        if not np.isfinite(y[k]):
            k += 1
            continue
        first, low, high, total = k, y[k], y[k], 0.0
        while k < y.size and np.isfinite(y[k]) and (k == first or fresh[k] == 0.0):
            if max(high, y[k]) - min(low, y[k]) > window:
                break
            low, high, total = min(low, y[k]), max(high, y[k]), total + y[k]
            k += 1
        found[count, 0], found[count, 1], found[count, 2] = first, k, total / (k - first)
        count += 1
    return found[:count]


@njit()
def _exceeds(distance: float, spread: float) -> float:
    """Probability that a threshold is exceeded by a distance of this spread."""
    return min(max(0.5 * math.erfc(-distance / (1.4142135623730951 * spread)), NEVER), 1.0)


@njit()
def _density(error: float, variance: float) -> float:
    return math.exp(-0.5 * error * error / variance) / math.sqrt(6.283185307179586 * variance)


@njit()
def _slips(error: float, half: float, rest: float) -> float:
    """Way of a position that slips, each time by half - rest, while the command goes on in a straight line."""
    jump = half - rest
    if error <= half or jump <= 1e-3 * half:
        return max(error - half, 0.0)
    return jump * (math.floor((error - half) / jump) + 1.0)


@njit()
def _moves(
    error: float,
    y: float,
    variance: float,
    half: float,
    rest: float,
    approach: float,
    rate: float,
    noise: float,
    scatter: float,
    landing: float,
) -> tuple[float, float, float, float, float]:
    """Hypotheses of a position at rest, all relative to it, y too: densities of hold, up, down; both moves."""
    sigma = math.sqrt(variance + scatter)
    p_up, p_down = _exceeds(error - half, sigma), _exceeds(-error - half, sigma)
    hold = max(1.0 - p_up - p_down, NEVER) * _density(y, variance + noise)
    up, down = min(approach * max(error - rest, 0.0), rate), -min(approach * max(-error - rest, 0.0), rate)
    b, d = p_up * _density(y - up, landing + noise), p_down * _density(y - down, landing + noise)
    if rest < half:  # slips of one length each are as likely as one that ends at the command
        slipped = min(approach * _slips(error, half, rest), rate)
        other = p_up * _density(y - slipped, landing + variance + noise)
        up, b = (slipped if other > b else up), 0.5 * (b + other)
        slipped = -min(approach * _slips(-error, half, rest), rate)
        other = p_down * _density(y - slipped, landing + variance + noise)
        down, d = (slipped if other > d else down), 0.5 * (d + other)
    return hold, b, d, up, down


@njit()
def _merged(
    y: float,
    weights: tuple[float, float, float, float],
    moves: tuple[float, float],
    variance: float,
    spread: float,
    noise: float,
) -> tuple[float, float]:
    """Mean, relative to that before, and variance of hold, up, down and unexplained with these weights."""
    gain_hold, gain_move = variance / (variance + noise), spread / (spread + noise)
    hold = gain_hold * y
    up, down = moves[0] + gain_move * (y - moves[0]), moves[1] + gain_move * (y - moves[1])
    a, b, d, o = weights
    mean = a * hold + b * up + d * down + o * y
    variance = (
        a * (gain_hold * noise + (hold - mean) ** 2)
        + b * (gain_move * noise + (up - mean) ** 2)
        + d * (gain_move * noise + (down - mean) ** 2)
        + o * (noise + (y - mean) ** 2)
    )
    return mean, variance


@njit()
def filtered(
    v: FloatArray,
    y: FloatArray,
    fresh: FloatArray,
    theta: FloatArray,
    wide: float,
    per_row: FloatArray,
    x: FloatArray,
    skipped: int,
) -> float:
    """Log-likelihood of the position y (n,); fill its parts `per_row` and the filtered position `x`.

    `fresh` is 1 where a row does not follow its predecessor; NaN in v or y counts as a missing measurement. `wide` is
    the standard deviation of a move that the command does not explain. `theta`: see the indices of this module; rates
    in units a sample, `APPROACH` the share of the way to the target in a sample.
    """
    offset, half, rest = theta[OFFSET], theta[HALF], theta[REST] * theta[HALF]
    approach, rate = theta[APPROACH], theta[RATE]
    noise, landing = theta[NOISE] ** 2, theta[LANDING_SCATTER] ** 2
    scatter = theta[THRESHOLD_SCATTER] ** 2
    near = max(ARRIVED * half, theta[NOISE])
    mean, variance, target, way = y[0], noise, y[0], 0.0
    total, started = 0.0, False
    for k in range(v.size):
        per_row[k], x[k] = 0.0, mean
        if not (np.isfinite(v[k]) and np.isfinite(y[k])):
            started = False
            continue
        if not started or fresh[k] == 1.0:
            started, mean, variance, target, way = True, y[k], noise, y[k], 0.0
            x[k] = mean
            continue
        goal, seen = v[k] - offset - mean, y[k] - mean
        if way != 0.0:  # on its way: the target follows the command in this direction only
            follow = goal + mean - way * rest
            target = max(target, follow) if way > 0.0 else min(target, follow)
            up = down = min(max(approach * (target - mean), -rate), rate)
            spread = landing + variance
            moving = _density(seen - up, spread + noise)
            a = NEVER * _density(seen, variance + noise)
            b, d = (moving, NEVER * moving) if way > 0.0 else (NEVER * moving, moving)
            aim_up = aim_down = target
        else:
            spread = landing
            a, b, d, up, down = _moves(goal, seen, variance, half, rest, approach, rate, noise, scatter, landing)
            aim_up, aim_down = mean + max(goal - rest, 0.0), mean + min(goal + rest, 0.0)
        a, b, d = (1.0 - UNEXPLAINED) * a, (1.0 - UNEXPLAINED) * b, (1.0 - UNEXPLAINED) * d
        o = UNEXPLAINED * _density(seen, variance + wide * wide)
        all_of = a + b + d + o + 1e-300
        per_row[k] = math.log(all_of)
        total += per_row[k] if k >= skipped else 0.0
        a, b, d, o = a / all_of, b / all_of, d / all_of, o / all_of
        moved, variance = _merged(seen, (a, b, d, o), (up, down), variance, spread, noise)
        mean += moved
        if b > 0.5:
            target, way = aim_up, (1.0 if aim_up - mean > near else 0.0)
        elif d > 0.5:
            target, way = aim_down, (-1.0 if mean - aim_down > near else 0.0)
        else:
            target, way = mean, 0.0
        x[k] = mean
    return total
