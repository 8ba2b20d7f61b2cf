"""A kind that was asked for beside the others: is one of them likelier? As little is fitted as that takes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.choice import choose_kind
from lostmotion.identify.actuators.every_kind import likely_kinds
from lostmotion.identify.actuators.kind import NO_FAULT, Kind, faults, kind_of
from lostmotion.identify.actuators.operator_profile import LaggedRegression, lags_of
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.excerpt import excerpt
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import ScaledData

LOOK_ROWS = 1500  # liveliest, of a first look at the other kinds
FAR_AHEAD, SMALL_SHARE = 30.0, 0.25  # of log-likelihood in that look, and what of it the others explain at most


@dataclass(frozen=True)
class AskedKind:
    """Comparison of a fit of the kind asked for with the other kinds.

    Attributes
    ----------
    scaled : ScaledData
    asked : Asked
    fit : callable
        Fit of one kind to data, from where it was sought, near another fit.
    """

    scaled: ScaledData
    asked: Asked
    fit: Callable[[ScaledData, Kind, Sought, Fitted | None], Fitted]

    def likelier(self, found: Fitted, linear: Fitted) -> tuple[str, float] | None:
        """Kind that is likelier than the one found, and by how much log-likelihood, less what parameters cost.

        First a look at few rows and places, which ends most cases where the kind asked for explains the record; then
        the profiles of all kinds, and fits of those that are not hopelessly behind. Loads beside them are not sought.
        """
        mine = kind_of(found.problem.family.kind)
        if self._far_ahead(found, mine):
            return None
        rivals = {name: sought for name, sought in likely_kinds(self.scaled, self.asked).items() if name != mine.name}
        fits = {name: self.fit(self.scaled, kind_of(name), sought, found) for name, sought in rivals.items()}
        fits = {name: one for name, one in fits.items() if kind_of(name).met(one)}
        if not fits:
            return None
        simplest = {name: kind_of(name).simplest(one) for name, one in {mine.name: found, **fits}.items()}
        return choose_kind(self.scaled, {NO_FAULT: linear, **simplest}).ahead_of(mine.name)

    def _far_ahead(self, found: Fitted, mine: Kind) -> bool:
        """Whether it explains so much of the liveliest rows that the others, which explain little, need no search."""
        data = replace(self.scaled, segments=excerpt(self.scaled, LOOK_ROWS))
        lagged = LaggedRegression.on(data, lags_of(data, self.asked), LOOK_ROWS)
        linear = lagged.squares(data.u)

        def gain(family: Family, eta: FloatArray) -> float:
            x = np.empty(data.u.size)
            family.path(eta, data.u, x)
            return float(0.5 * lagged.samples * np.log(max(linear, 1e-300) / max(lagged.squares(x), 1e-300)))

        ahead = gain(found.problem.family, found.actuator)
        if ahead < FAR_AHEAD:
            return False
        others = (kind for kind in faults() if kind is not mine)
        return all(gain(*place) < SMALL_SHARE * ahead for kind in others for place in kind.glance(data))
