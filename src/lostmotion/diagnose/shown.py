"""Whether a record shows the dead zone that fits it, or a valve that sticks would have looked the same."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit

# of a dead zone that fits: its other side, or that it ends inside the range of OP, the record does not show
NOT_SHOWN = (Status.ONE_SIDED, Status.NEAR_RANGE, Status.NOT_CONVERGED)
# From end to end by OP. A valve that sticks loses motion wherever OP turns round, a dead zone at one place only, and
# that it is always the same place takes several crossings to see. Of 48 simulated records for which a dead zone was
# likeliest, 32 of the 35 with four or more had one, and 3 of the 13 with fewer.
FEWEST_CROSSINGS = 4


def not_shown(fit: HammersteinFit) -> str:
    """Why the record does not show the dead zone of this fit, in words; empty where it does."""
    if not fit.kind.dead_between:
        return ""
    name = fit.kind.name
    if fit.status in NOT_SHOWN:
        return f"a {name} fits, but the record does not show it whole"
    left, right = fit.parameters["left"], fit.parameters["right"]
    times = sum(crossings(fit.data.u[start:stop], left, right) for start, stop in fit.data.segments.tolist())
    if times < FEWEST_CROSSINGS:
        often = ("never crosses it", "crosses it once only", "crosses it twice only")
        said = often[times] if times < len(often) else f"crosses it {times} times only"
        return f"a {name} fits, but OP {said}: a valve that sticks could look the same"
    return ""


def crossings(op: FloatArray, left: float, right: float) -> int:
    """How often OP goes from one side of [left, right] to the other.

    Examples
    --------
    >>> crossings(np.array([-2.0, 0.0, 2.0, 0.0, 2.0, -2.0]), -1.0, 1.0)
    2
    """
    side = np.where(op > right, 1, np.where(op < left, -1, 0))
    outside = side[side != 0]
    return int(np.count_nonzero(outside[1:] != outside[:-1]))
