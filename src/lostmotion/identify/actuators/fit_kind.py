"""One fit of a kind of actuator: starts from its profile, likelihood, last steps where it has kinks."""

from __future__ import annotations

from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.actuators.no_fault import NONE
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.search import best_fit
from lostmotion.identify.scaled import ScaledData


def fit_kind(
    sought: Sought, data: ScaledData, asked: Asked, near: Fitted | None = None, beside: Fitted | None = None
) -> Fitted:
    """Global maximum of the likelihood of one kind.

    Parameters
    ----------
    sought : Sought
        From ``Kind.sought``.
    data : ScaledData
    asked : Asked
        Orders and noise, where they are not to be chosen from the data.
    near, beside : Fitted or None
        As in ``best_fit``.
    """
    best = best_fit(data, sought.family, sought.etas, asked, near, beside)
    return kind_of(sought.family.kind).finished(best)


def fit_linear(data: ScaledData, asked: Asked) -> Fitted:
    """The same without a fault."""
    return fit_kind(NONE.sought(data, asked), data, asked)
