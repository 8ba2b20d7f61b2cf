"""What speaks for the actuator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray

# From end to end by OP. A valve that sticks loses motion wherever OP turns round, a dead zone at one place only, and
# that it is always the same place takes several crossings to see. Of 48 simulated records for which a dead zone was
# likeliest, 32 of the 35 with four or more had one, and 3 of the 13 with fewer.
FEWEST_CROSSINGS = 4
NEARLY_EXACT = 1e-3  # share of the moves of OP that PV does not explain, below which OP is a function of PV


@dataclass(frozen=True)
class Evidence:
    """Comparison of the models that were fitted to the same rows.

    Attributes
    ----------
    gain_over_linear : float
        BIC(linear) - BIC(this model): above 0 favours this model, above 10 strongly. 0 for a linear fit.
    gain_over_no_input : float
        BIC(autoregression of PV alone) - BIC(linear): below 0 OP hardly moves PV.
    samples_left, samples_right : int
        Rows in which OP is beyond the break points.
    rivals : tuple of (left, right, behind)
        Other dead zones that fit about as well, and by how much BIC they are behind (rough fits).
    closed_loop : bool
        OP answers PV.
    free_moves : float
        Share of the moves of OP that PV does not explain (set-point moves, tests, operators).
    other_kind : (str, float) or None
        Kind that is likelier than the one asked for, and by how much log-likelihood, less what parameters cost.
    crossings : int or None
        Times that OP went through a dead zone from end to end, see :func:`crossings`; None: no dead zone, or a fit
        saved before they were counted.
    unseen_moves : float
        Deviation of OP between the rows, as far as it hides or fills the lost motion of this kind, see ``Unseen``; 0:
        the rows show all.
    gain_over_healthy : float or None
        The same of a dead zone or a saturation over the likeliest healthy valve, which may bend or be slow
        (``Kind.healthy``); None: a straight line is the likeliest, or a fit saved before it was asked.
    by_prediction : (str, float or None) or None
        Kind that one-step predictions name, and its size, where free simulation from OP names or sizes it otherwise and
        counts; None: both agree, or the loop is closed.
    actuator_lag : float
        Seconds by which the actuator lags before its lost motion, where the record shows it; 0: it shows none.
    answered : bool
        Whether PV answers what is new in OP, see ``pv_answers``; True in an open loop, and of a fit saved before it was
        asked. Where it is not, a valve that stands still would have left the same record.
    foreknown : bool
        Whether the controller knows more than the rows, which answer moves of OP however small: OP foretells PV against
        the way in which the valve moves it, see ``foretold``, or moves mostly between the rows, see ``Unseen``.
    load_drifts : bool
        Whether the noise model is a drifting load disturbance and white measurement noise, which identifies a level
        without moves of the set point.
    """

    gain_over_linear: float
    gain_over_no_input: float
    samples_left: int
    samples_right: int
    rivals: tuple[tuple[float, float, float], ...] = ()
    closed_loop: bool = False
    free_moves: float = 1.0
    other_kind: tuple[str, float] | None = None
    crossings: int | None = None
    unseen_moves: float = 0.0
    answered: bool = True
    actuator_lag: float = 0.0
    gain_over_healthy: float | None = None
    foreknown: bool = False
    by_prediction: tuple[str, float | None] | None = None
    load_drifts: bool = False

    @property
    def gain(self) -> float:
        """Over whatever explains the record without this fault."""
        return self.gain_over_linear if self.gain_over_healthy is None else self.gain_over_healthy

    @property
    def can_exclude(self) -> bool:
        """Whether a lost motion that the record does not show can be excluded by it."""
        return self.answered and not self.foreknown

    @property
    def exact_feedback(self) -> bool:
        """Whether OP is a function of PV."""
        return self.closed_loop and self.free_moves < NEARLY_EXACT

    @property
    def only_fed_back(self) -> bool:
        """Whether OP is one, and the process cannot be told from others that foretell PV as well."""
        return self.exact_feedback and not self.load_drifts

    @property
    def crossed_enough(self) -> bool:
        """Whether OP went through the dead zone so often that a valve that sticks would have looked different."""
        return self.crossings is None or self.crossings >= FEWEST_CROSSINGS


def crossings(op: FloatArray, segments: IntArray, left: float, right: float) -> int:
    """How often OP goes from one side of [left, right] to the other, inside each segment; noise at an end counts once.

    Parameters
    ----------
    op : ndarray, shape (n,)
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    left, right : float
        In units of OP.

    Examples
    --------
    >>> crossings(np.array([-2.0, 0.0, 2.0, 0.9, 2.0, -2.0]), np.array([[0, 6]]), -1.0, 1.0)
    2
    """
    found = 0
    for start, stop in segments.tolist():
        side = np.where(op[start:stop] > right, 1, np.where(op[start:stop] < left, -1, 0))
        outside = side[side != 0]
        found += int(np.count_nonzero(outside[1:] != outside[:-1]))
    return found
