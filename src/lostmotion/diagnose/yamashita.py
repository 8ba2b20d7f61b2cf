"""How often does OP move and PV stand still? Qualitative shapes of the valve's path."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.diagnose.filters import checked_period, low_pass, standard_signal
from lostmotion.errors import DataError

THIRDS = 0.4307  # of a standard deviation: a Gaussian move is down, steady or up in a third of the cases each
STEPS = 24  # in a period: noise that is faster counts for nothing
HARMONICS = 7.0  # kept, as in the half periods: noise above them is none of the wave form's
SS, IS, DS = 4, 7, 1  # 3 * (move of OP + 1) + (move of PV + 1)
WITH_IS = (8, 5)  # II and SI: the valve follows OP at last
WITH_DS = (0, 3)  # DD and SD


@dataclass(frozen=True)
class Qualitative:
    """Share of time in sticky movements; a random path has 0.25, which is the published limit.

    Parameters
    ----------
    rho1 : float
        OP moves and PV stands still, of all time in which anything moves.
    rho2 : float
        The part after which PV moves the way OP went.
    rho3 : float
        rho1 without the part after which something else than sticking happens.
    """

    rho1: float
    rho2: float
    rho3: float


def yamashita_index(op: FloatArray, pv: FloatArray, period: float) -> Qualitative:
    """Count the sticky movements in the path of PV over OP.

    Parameters
    ----------
    op, pv : ndarray, shape (n,)
        Finite, uniformly sampled. PV must follow the valve at once: position of the valve, or flow through it.
    period : float
        Period of the oscillation in samples, at least 4.

    Raises
    ------
    DataError
        Fewer than two periods, or a constant signal.

    Notes
    -----
    Yamashita (2006), "An automatic method for detection of valve stiction in process control loops", Control Eng.
    Practice 14:503. Moves are increasing (I), steady (S) or decreasing (D). Deviations: moves over 1/24 of a period
    of signals without what is above the 7th harmonic; limit between steady and moving at 0.43 standard deviations of
    the moves, which makes the three equally likely for a random path, as the published limit of 1/4 assumes; PV is
    turned round where it moves against OP.

    Examples
    --------
    >>> path = np.sin(2 * np.pi * np.arange(2000) / 100)
    >>> yamashita_index(path, path, 100).rho1
    0.0
    """
    u, y = standard_signal("op", op, 16), standard_signal("pv", pv, 16)
    if u.size != y.size:
        raise DataError.expected(f"pv with {u.size} samples", y.size, "cut both signals to the same length")
    period = checked_period(period, u.size)
    step = max(1, round(period / STEPS))
    du, dy = (np.diff(low_pass(x, period / HARMONICS)[::step]) for x in (u, y))
    dy = dy * (-1.0 if du @ dy < 0.0 else 1.0)
    moves = 3 * (_moves(du) + 1) + _moves(dy) + 1
    starts = np.flatnonzero(np.diff(moves, prepend=-1))
    lengths = np.diff(np.append(starts, moves.size))
    kind, following = moves[starts], np.append(moves[starts[1:]], SS)  # after the last run nothing is known
    time = max(int((moves != SS).sum()), 1)
    sticky = np.isin(kind, (IS, DS))
    follows = ((kind == IS) & np.isin(following, WITH_IS)) | ((kind == DS) & np.isin(following, WITH_DS))
    rho1, rho2 = lengths[sticky].sum() / time, lengths[follows].sum() / time
    other = lengths[sticky & ~follows & (following != SS)].sum() / time
    return Qualitative(float(rho1), float(rho2), float(rho1 - other))


def _moves(difference: FloatArray) -> IntArray:
    """-1, 0 or 1 for down, steady or up."""
    limit = THIRDS * float(difference.std())
    return (difference > limit).astype(np.int64) - (difference < -limit).astype(np.int64)
