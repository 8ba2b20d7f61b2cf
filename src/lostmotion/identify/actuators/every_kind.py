"""Fits of all likely kinds of actuator, and the linear model that a fault must beat."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.break_away import broken_away
from lostmotion.identify.actuators.characteristic import bent
from lostmotion.identify.actuators.directional_lag import centre_of, directional, promises
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.kind import Kind, faults, kind_of
from lostmotion.identify.actuators.loads import (
    loaded,
    pruned,
    sizes_of_loads,
    swings_of,
    with_loads,
    with_own_loads,
    without_actuator,
    without_loads,
    without_swings,
    without_their_effect,
)
from lostmotion.identify.actuators.operator_profile import regression
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import gain_over_linear
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import ScaledData

SEEN = 6.0  # of BIC, by which the nested kind must beat the linear model before the other is sought beside it
FOUND = 60.0  # of BIC: a kind so far ahead of the one that it nests has its last parameter
BELIEVED = 60.0  # of BIC over the linear model: its size is told
HOPELESS = 30.0  # of log-likelihood behind the profile of the best kind
WORTHWHILE = 3.0  # of log-likelihood, before a kind is fitted in full

Fits = dict[str, Fitted]


@dataclass(frozen=True)
class EveryKind:
    """Search over all kinds on one set of data.

    Attributes
    ----------
    scaled : ScaledData
    asked : Asked
    fit : callable
        Fit of one kind to data, from where it was sought, near another fit.
    asymmetric : bool
        Whether the lag of the process may differ with direction.
    """

    scaled: ScaledData
    asked: Asked
    fit: Callable[[ScaledData, Kind, Sought, Fitted | None], Fitted]
    asymmetric: bool = False

    def fits(self, linear: Fitted) -> tuple[Fitted, Fits]:
        """Best linear fit, and fits of the likely kinds, each with the loads that pay beside it.

        In open loop once more with a lag that differs with direction, where the errors of the best promise one.
        """
        plain, found = self._fits(linear)
        if feedback(self.scaled).closed:
            return plain, found
        best = max([plain, *found.values()], key=lambda one: gain_over_linear(one, plain))
        if not promises(best, centre_of(self.scaled, best)):
            return plain, found
        return replace(self, asymmetric=True)._fits(linear)

    def _fits(self, linear: Fitted) -> tuple[Fitted, Fits]:
        """The same with a lag as it is.

        Where the linear model finds loads, all are sought once more without their effect, which hides from the profile
        what the actuator does.
        """
        linear = self._beside_swings(self._cleaned(self._completed(linear)))
        likely = self._of_likely(self.scaled, without_loads(linear))
        found = {kind: self._completed(one) for kind, one in likely.items()}
        self._without_loads_of(linear, found)
        nested = [kind for kind in faults() if kind.nests]
        for kind in nested:
            if kind.name in found:
                _keep(found, kind.nests, self._completed(kind.simplified(found[kind.name])))
        linear = _best_linear(linear, found)
        for kind in nested:
            linear = further(found, kind, linear, self.asked, self._completed)
        return linear, found

    def _beside_swings(self, linear: Fitted) -> Fitted:
        """The linear model, also sought without the swings: the process may have taken the place of one."""
        swings = swings_of(self.scaled)
        if swings is None:
            return linear
        other = with_loads(fit_linear(without_swings(self.scaled, swings), self.asked), self.scaled, swings)
        return other if gain_over_linear(other, linear) > 0 else linear

    def _without_loads_of(self, linear: Fitted, found: Fits) -> None:
        """Better fits on what is left of PV without the loads of the linear model."""
        loads = linear.problem.family.loads
        if loads is None:
            return
        clean = without_their_effect(linear, self.scaled)
        for kind, one in self._of_likely(clean, without_loads(linear, clean.y)).items():
            other = self._completed(pruned(loaded(one, self.scaled.y, loads, sizes_of_loads(linear))))
            _keep(found, kind, other)

    def _cleaned(self, linear: Fitted) -> Fitted:
        """The linear model sought anew without its loads, and refined with them, where that is better."""
        loads = linear.problem.family.loads
        if loads is None:
            return linear
        clean = without_their_effect(linear, self.scaled)
        again = fit_linear(clean, self.asked)
        again = self._completed(pruned(loaded(again, self.scaled.y, loads, sizes_of_loads(linear))))
        return again if gain_over_linear(again, linear) > 0 else linear

    def _of_likely(self, data: ScaledData, linear: Fitted) -> Fits:
        """Each kind but those with most local maxima begins at the best before it."""
        found: Fits = {}
        for name, sought in likely_kinds(data, self.asked).items():
            kind = kind_of(name)
            nearest = max([linear, *found.values()], key=lambda other: gain_over_linear(other, linear))
            fitted = self.fit(data, kind, sought, None if kind.begins_alone or not found else nearest)
            if kind.met(fitted):
                found[name] = fitted
        return found

    def _completed(self, fitted: Fitted) -> Fitted:
        """The model with what a sound plant may do besides, where it pays.

        A characteristic that bends, a lag that differs with direction, swings and steps of load.
        """
        fitted = bent(fitted)
        if self.asymmetric:
            fitted = directional(fitted, centre_of(self.scaled, fitted), self.asked.orders is None)
        return with_own_loads(broken_away(fitted))


def _best_linear(linear: Fitted, found: Fits) -> Fitted:
    """What a fault must beat: the best linear model, also in the structure of every fault that was found."""
    rivals = [linear, *(without_actuator(one) for one in found.values())]
    return max(rivals, key=lambda one: gain_over_linear(one, linear))


def likely_kinds(data: ScaledData, asked: Asked) -> dict[str, Sought]:
    """Kinds whose profile explains more than a linear model and is not hopelessly behind another, likeliest first.

    Long records are not sought on the same rows by all; there the best places are compared on those of the shortest.
    """
    lagged = regression(data, asked)
    rows = lagged.samples
    whole = rows == sum(stop - start for start, stop in lagged.lags.rows(data.segments))
    found = {kind.name: kind.sought(data, asked) for kind in faults()}
    squares = {
        kind: sought.squares if whole else lagged.squares(path_of(sought, data.u)) for kind, sought in found.items()
    }
    behind = {kind: 0.5 * rows * np.log(max(value, 1e-300)) for kind, value in squares.items()}
    linear = 0.5 * rows * np.log(max(lagged.squares(data.u), 1e-300))
    order = sorted(found, key=lambda kind: behind[kind])
    best = behind[order[0]]
    likely = [kind for kind in order if behind[kind] < best + HOPELESS]
    alike = [kind_of(kind).looks_like for kind in likely]
    likely += [kind for kind in dict.fromkeys(alike) if kind in found and kind not in likely]
    kept = {kind: found[kind] for kind in likely if kind_of(kind).always_tried or behind[kind] < linear - WORTHWHILE}
    return kept or {order[0]: found[order[0]]}


def path_of(sought: Sought, u: FloatArray) -> FloatArray:
    """Internal variable (n,) of the best place."""
    x = np.empty(u.size)
    sought.family.path(sought.etas[0], u, x)
    return x


def _keep(found: Fits, kind: str, other: Fitted) -> bool:
    """Take a fit where it is the first of its kind or better."""
    better = kind not in found or gain_over_linear(other, found[kind]) > 0
    if better:
        found[kind] = other
    return better


def further(
    found: Fits, kind: Kind, linear: Fitted, asked: Asked, beside: Callable[[Fitted], Fitted] = lambda one: one
) -> Fitted:
    """Put better fits of a kind into `found`, from the one that it nests and from a second search of its own.

    `beside` adds what else acts to a fit, as loads. Returns the best linear model.
    """
    for way in (_enriched, _sought_again):
        other = way(found, kind, linear, asked)
        if other is None:
            continue
        other = beside(other)
        if kind.met(other) and _keep(found, kind.name, other):
            linear = _best_linear(linear, found)
    return linear


def _enriched(found: Fits, kind: Kind, linear: Fitted, asked: Asked) -> Fitted | None:  # noqa: ARG001
    """The kind begun at the one that it nests, while that is open."""
    return kind.enriched(found[kind.nests]) if is_open(kind, found, linear) else None


def _sought_again(found: Fits, kind: Kind, linear: Fitted, asked: Asked) -> Fitted | None:
    """The kind sought a second time, where it or the one that it nests is so clearly ahead that its size is believed.

    A size that is one of many peaks of the likelihood must not stand on one search alone.
    """
    fits = [found[name] for name in (kind.name, kind.nests) if name in found]
    best = max(fits, key=lambda one: gain_over_linear(one, linear), default=linear)
    return None if gain_over_linear(best, linear) < BELIEVED else kind.sought_again(best, asked)


def is_open(kind: Kind, found: Fits, linear: Fitted) -> bool:
    """Whether the nested kind is seen, and this one not so much more that its last parameter was surely found."""
    if kind.nests not in found:
        return False
    gain = gain_over_linear(found[kind.nests], linear)
    return gain > SEEN and (kind.name not in found or gain_over_linear(found[kind.name], linear) < gain + FOUND)
