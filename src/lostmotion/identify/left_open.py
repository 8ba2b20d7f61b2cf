"""Lost motion that a record leaves open, beside what was found in it."""

from __future__ import annotations

import numpy as np

from lostmotion.errors import Status
from lostmotion.identify.actuators.choice import CONFIRMED, KindChoice
from lostmotion.identify.actuators.excluded import largest_sizes, nothing_excluded
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.identify.earned import CLAIMS
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import Scaling
from lostmotion.identify.status import excluded_sizes

DENIED = 30.0  # firm gain in log-likelihood: a fault with less may be denied, by what else is known of the loop


def left_open(
    linear: Fitted,
    fits: dict[str, Fitted],
    beside: HammersteinFit,
    scaling: Scaling,
    slow: bool = False,
    ahead: float = 0.0,
) -> dict[str, float]:
    """Largest size of every kind that the record does not exclude (95 %), in units of OP.

    Parameters
    ----------
    linear : Fitted
    fits : dict of Fitted
        Of the kinds.
    beside : HammersteinFit
        The linear model as a result.
    slow : bool
        Whether the valve may be slow, which is no linear model.
    ahead : float
        Log-likelihood by which what was found is surely ahead of the linear model.
    """
    # without moves of its own OP leaves the process open beside a rich model of the noise
    told = beside.evidence.can_exclude and not beside.evidence.only_fed_back
    seen = beside.status is not Status.CANNOT_TELL and told and not slow
    sizes = largest_sizes(linear, fits, ahead) if seen else nothing_excluded()  # a valve that stands still would do
    return excluded_sizes(sizes, beside.data, scaling)


def untold(found: HammersteinFit) -> bool:
    """Whether a linear model claims what the record does not tell: that there is no fault, where it excludes none."""
    if found.kind.name != NO_FAULT or found.kinds is None or found.status not in CLAIMS:
        return False
    excluded = np.isfinite([*found.kinds.excluded.values()]).any()
    return bool(not excluded or (found.status is Status.OK and found.preferred != NO_FAULT))


def may_be_denied(found: HammersteinFit, kinds: KindChoice, sound: float) -> bool:
    """Whether a fault is so small, or gains so little, that a verdict may go without it; `sound` is in units of OP."""
    small = found.kind.size is not None and largest_known(found) < sound
    return small or kinds.firm[kinds.best] < DENIED


def largest_known(found: HammersteinFit) -> float:
    """Upper end of the size of a kind that has one, without moves of OP that may or may not be between the rows."""
    end = float(found.interval(str(found.kind.size))[1])
    return found.data.unseen.doubted(end, found.evidence.unseen_moves, found.kind.sticks)


def surely_ahead(kinds: KindChoice) -> float:
    """Log-likelihood by which the best kind is ahead of the linear model, less what a search gains by chance."""
    return max(kinds.firm[kinds.best] - CONFIRMED, 0.0)


def with_found(sizes: dict[str, float], found: HammersteinFit) -> dict[str, float]:
    """Sizes with that of the fault that was found: not less than the upper end of its interval."""
    name = found.kind.size
    return sizes if name is None else sizes | {found.kind.name: max(sizes[found.kind.name], found.interval(name)[1])}
