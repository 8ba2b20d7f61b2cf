"""Does OP foretell PV against the way in which the valve moves it? Then the controller knows more than the rows.

A controller that acts on the slope of PV, or between the rows, on a PV that is recorded late or averaged, or on a load
that it measures, has seen what the next row of PV will show, and has moved OP against it. To a model of the process
that is an answer of PV to OP, although no valve has moved, and to every move however small: sizes of lost motion are
then excluded that are there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.identify.news import longest, news, standard

LAGS = 12  # rows of OP, PV and SP that tell what the controller did by itself, and of PV that foretell it
AHEAD = 6  # rows of PV afterwards; a load arrives for as long as the process takes to settle
# standard errors
AGAINST = 5.0
# of the moves of OP: where less is news, moves of SP say more. Fast controllers have seen PV between the rows, but say
# little of it: of sound valves a third would be beyond AGAINST
LEAST = 0.03


@dataclass(frozen=True)
class Foretold:
    """What OP says of PV beyond its past.

    Attributes
    ----------
    errors : ndarray, shape (6,)
        Correlation of what is new in OP with what is new in PV one to six rows later, in standard errors.
    share : float
        Share of the variance of the moves of OP that is new.
    """

    errors: FloatArray
    share: float

    def against(self, gain: float) -> bool:
        """Whether PV goes the other way than a process of this gain would move it."""
        return self.share >= LEAST and bool(np.min(math.copysign(1.0, gain) * self.errors) < -AGAINST)


def foretold(u: FloatArray, y: FloatArray, segments: IntArray, sp: FloatArray | None = None) -> Foretold:
    """Correlate what past OP, PV and SP up to now do not tell of OP with what its past does not tell of PV.

    Parameters
    ----------
    u, y : ndarray, shape (n,)
        OP and PV, segments one after the other.
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    sp : ndarray, shape (n,), optional
        Set point, where it is known.

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> load, whole = 0.1 * rng.normal(size=3000).cumsum(), np.array([[0, 2999]])
    >>> pv, op = np.zeros(3000), np.zeros(3000)
    >>> for now in range(1, 3000):
    ...     pv[now] = 0.8 * pv[now - 1] + 0.2 * op[now - 1] + load[now] + 0.1 * rng.normal()
    ...     op[now] = op[now - 1] - 0.5 * (pv[now] - pv[now - 1]) - 0.1 * pv[now] + 0.1 * rng.normal()
    >>> foretold(op[1:], pv[1:], whole).against(0.2), foretold(op[1:], pv[:-1], whole).against(0.2)
    (False, True)
    """
    spans = longest(segments)
    known = (standard(y),) if sp is None or float(np.ptp(sp)) == 0.0 else (standard(y), standard(sp))
    of_op, of_pv = news(standard(u), known, spans, LAGS), news(standard(y), (), spans, LAGS)
    pairs = [(start + LAGS, stop - AHEAD) for start, stop in spans if stop - start > 2 * LAGS + AHEAD]
    if not pairs:
        return Foretold(np.zeros(AHEAD), 0.0)
    before = np.concatenate([of_op[start:stop] for start, stop in pairs])
    moves = np.concatenate([np.diff(standard(u)[start:stop]) for start, stop in pairs])
    errors = np.zeros(AHEAD)
    for ahead in range(AHEAD):
        after = np.concatenate([of_pv[start + ahead + 1 : stop + ahead + 1] for start, stop in pairs])
        size = math.sqrt(float(before @ before) * float(after @ after))
        errors[ahead] = float(before @ after) / size * math.sqrt(before.size) if size > 0.0 else 0.0
    return Foretold(errors, float(np.var(before) / max(np.var(moves), 1e-300)))
