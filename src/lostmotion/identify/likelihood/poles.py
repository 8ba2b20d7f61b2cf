"""Starts of the linear part: a grid of pole patterns, with the best B and delay for each by least squares.

The likelihood of a slow process of order two or three has many local maxima in its poles, and a high-order ARX with
some tens of lags does not see far enough to start it. From a start on the grid the refinement reached the global
maximum wherever it did from the true poles.
"""

from __future__ import annotations

import functools
import itertools
from typing import Any, NamedTuple

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.likelihood.excerpt import excerpt
from lostmotion.identify.likelihood.plausible import FREE, Held
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import pole_grid as kernel

TIME_CONSTANTS = (0.7, 1.5, 3.0, 6.0, 12.0, 24.0, 48.0, 100.0, 400.0)  # samples; and an integrator
# samples: the second and third pole and pairs, a factor of 2.5 to 3 apart; with TIME_CONSTANTS and DAMPING some 230
# patterns (docs/method.md)
COARSE = (1.0, 3.0, 8.0, 20.0, 50.0, 150.0)
# of pairs, about a factor of 2 apart; from 0.1, below which `plausible` refuses, to where a pair is two lags
DAMPING = (0.15, 0.35, 0.65)
OTHER_POLE = 0.2  # of orders above three
NEARLY_INTEGRATING = 0.997  # a slower pole than this may be an integrator
ROUNDING = 1e-9  # from 1: what is nearer is an integrator
FASTEST_RINGING = 2.6  # radians a sample
MOST_ROWS = 6000  # enough to tell poles apart
# of a first look at whitened signals, and of log rss there: patterns that served later were within 30 (six open loops)
FEW_ROWS, FAR_BEHIND = 1000, 100.0
NEXT_DELAY = 2  # there: what lies between is seen by the next coefficient of B
_SCAN: Any = kernel.scan


class GridStart(NamedTuple):  # thousands of them are made to keep a few: a dataclass takes ten times as long
    """One start: orders, delay, A, B, its score n log(rss) + k log n, and its slowest mode."""

    na: int
    nb: int
    delay: int
    a: FloatArray
    b: FloatArray
    score: float
    decay: float  # 1: integrating

    @property
    def key(self) -> tuple[int, int, int, bool]:
        """What tells structures apart."""
        return self.na, self.nb, self.delay, self.decay == 1.0


@functools.cache
def patterns(na: int) -> tuple[FloatArray, FloatArray]:
    """Polynomials A (m, na) of sampled processes with na poles, and the slowest mode of each (m,)."""
    fine, coarse = ((*(float(np.exp(-1.0 / tau)) for tau in taus), 1.0) for taus in (TIME_CONSTANTS, COARSE))
    pairs = [(pair, np.conj(pair)) for pair in _oscillations()]
    sets: list[tuple[complex, ...]]
    if na <= 1:
        sets = [()] if na == 0 else [(pole,) for pole in fine]
    elif na == 2:
        real = itertools.combinations_with_replacement(fine, 2)
        sets = [*(poles for poles in real if poles[0] < 1.0), *pairs]
    else:
        rest = (OTHER_POLE,) * (na - 3)
        triples = itertools.combinations_with_replacement(coarse, 3)
        sets = [(*poles, *rest) for poles in triples if poles[1] < 1.0]
        sets += [(*pair, pole, *rest) for pair in pairs for pole in coarse]
    polynomials = np.array([np.real(np.poly(poles))[1:] if poles else np.zeros(0) for poles in sets])
    return polynomials, np.array([max((abs(pole) for pole in poles), default=0.0) for poles in sets])


def _given(polynomials: list[FloatArray], na: int) -> tuple[FloatArray, FloatArray]:
    """Those of this order as a pattern; poles next to 1 are integrators."""
    chosen = [a for a in polynomials if a.size == na]
    slowest = np.array([float(np.abs(np.roots(np.append(1.0, a))).max(initial=0.0)) for a in chosen])
    return np.array(chosen), np.where(slowest > 1.0 - ROUNDING, 1.0, slowest)


def simpler(a: FloatArray, integrating: bool) -> list[FloatArray]:
    """Polynomials A with some of the poles of this one, itself first; an integrator and pairs stay whole.

    Where the slowest pole is nearly an integrator, with that in its place as well.
    """
    rest = 1.0 + np.cumsum(a)[:-1] if integrating else a
    poles = np.roots(np.append(1.0, rest))
    groups = [(pole, np.conj(pole)) if pole.imag > 0.0 else (pole,) for pole in poles if pole.imag >= 0.0]
    sets = [sum(some, ()) for count in range(len(groups), -1, -1) for some in itertools.combinations(groups, count)]
    if integrating:
        return [a, *(_polynomial((*some, 1.0)) for some in sets[1:])]
    slow = [pole for pole in poles if pole.imag == 0.0 and pole.real > NEARLY_INTEGRATING]
    level = [tuple(1.0 if pole in slow[:1] else pole for pole in some) for some in sets if slow and slow[0] in some]
    return [a, *(_polynomial(some) for some in [*sets[1:], *level] if some)]


def _polynomial(poles: tuple[complex, ...]) -> FloatArray:
    return np.asarray(np.real(np.poly(poles))[1:])


def _oscillations() -> list[complex]:
    """Poles of underdamped pairs."""
    pairs = [
        complex(np.exp((-zeta + 1j * np.sqrt(1.0 - zeta**2)) / (tau * zeta))) for tau in COARSE[1:] for zeta in DAMPING
    ]
    return [pair for pair in pairs if 0.0 < np.angle(pair) < FASTEST_RINGING]


def grid_starts(
    data: ScaledData,
    x: FloatArray,
    d: FloatArray,
    ladder: tuple[tuple[int, int], ...],
    delays: tuple[int, int],
    integrating: bool | None = None,
    held: Held = FREE,
    only: list[FloatArray] | None = None,
    limit: float | None = np.inf,
) -> list[GridStart]:
    """Best start of every structure of the ladder, over delays low .. high, best first.

    Parameters
    ----------
    data : ScaledData
    x : ndarray, shape (n,)
        Internal variable.
    d : ndarray
        AR noise model with which both are whitened.
    ladder : tuple of (na, nb)
    delays : (int, int)
        First and last delay.
    integrating : bool or None
        Whether the process integrates; None: such starts are structures of their own, beside the others.
    held : Held
        What else is known of the process.
    only : list of ndarray, optional
        Polynomials A instead of the patterns of the grid; of these B is exact, of patterns nearly (``exact_start``).
    limit : float or None
        What is worse is left out; None: all but the best of every na.
    """
    low, high = delays
    rows = excerpt(data, MOST_ROWS)
    starts = []
    for na in sorted({na for na, _ in ladder}):
        polynomials, decays = patterns(na) if only is None else _given(only, na)
        if not len(decays):
            continue
        orders = max(nb for n, nb in ladder if n == na) + 1
        # where a controller is at work the best that is allowed may be far behind, and unless whitened rows tell little
        if only is None and integrating is None and d.size and not held.closed and data.u.size >= 2 * FEW_ROWS:
            near = _first_look(data, x, d, polynomials, decays, delays, orders)
            polynomials, decays = polynomials[near], decays[near]
        shape = (len(polynomials), orders, high - low + 1)
        rss, b = np.empty(shape), np.empty((*shape, orders))  # of each order as many of B as it has
        n = _SCAN(x, data.y, rows, d, polynomials, decays, low, high, orders, rss, b, only is None, 1)
        if n <= 0:
            continue
        kept: list[GridStart] = []
        kinds = [np.flatnonzero(kind) for kind in (decays < 1.0, decays == 1.0)]
        kinds = [kind for kind in kinds if kind.size and integrating in (None, bool(decays[kind[0]] == 1.0))]
        for nb in {nb for order, nb in ladder if order == na}:
            for chosen in kinds:
                best = held.best_allowed(rss[:, nb], chosen, polynomials, b[:, nb, :, : nb + 1])
                columns = np.flatnonzero(best >= 0)
                if not columns.size:
                    continue
                best = best[columns]
                misfits = n * np.log(np.maximum(rss[best, nb, columns], 1e-300) / n)
                scores = misfits + (na + nb + 2) * np.log(n)
                good = np.flatnonzero(scores < limit) if limit is not None else [int(scores.argmin())]
                for i in np.asarray(good).tolist():
                    row, column = best[i], columns[i]
                    gains = b[row, nb, column, : nb + 1].copy()
                    place = na, nb, int(low + column), polynomials[row], gains
                    kept.append(GridStart(*place, float(scores[i]), float(decays[row])))
        starts += [min(kept, key=_score)] if limit is None and kept else kept
    return sorted(starts, key=_score)


def _score(start: GridStart) -> float:
    return start.score


def _first_look(
    data: ScaledData,
    x: FloatArray,
    d: FloatArray,
    polynomials: FloatArray,
    decays: FloatArray,
    delays: tuple[int, int],
    orders: int,
) -> IntArray:
    """Indices of the patterns that are not far behind the best on few rows."""
    low, high = delays
    shape = (len(polynomials), orders, high - low + 1)
    rss, b = np.empty(shape), np.empty((*shape, orders))
    few = excerpt(data, FEW_ROWS)
    n = _SCAN(x, data.y, few, d, polynomials, decays, low, high, orders, rss, b, True, NEXT_DELAY)
    misfits = n * np.log(np.maximum(rss[:, :, ::NEXT_DELAY].min(axis=(1, 2)), 1e-300))
    return np.flatnonzero(misfits <= misfits.min() + FAR_BEHIND)


def exact_start(
    data: ScaledData,
    x: FloatArray,
    d: FloatArray,
    ladder: tuple[tuple[int, int], ...],
    delays: tuple[int, int],
    start: GridStart,
) -> GridStart:
    """One of the ``grid_starts``, arguments as there, with B to rounding."""
    if start.decay == 0.0:  # no pole, or no start at all
        return start
    low, high = delays
    orders = max((nb for na, nb in ladder if na == start.na), default=start.nb) + 1
    rss, b = np.empty((1, orders, high - low + 1)), np.zeros((1, orders, high - low + 1, orders))
    a, decay = start.a[None], np.array([start.decay])
    n = _SCAN(x, data.y, excerpt(data, MOST_ROWS), d, a, decay, low, high, orders, rss, b, False, 1)
    return start._replace(b=b[0, start.nb, start.delay - low, : start.nb + 1]) if n > 0 else start
