"""Stiction: a valve that rests until OP has gone far enough, then jumps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import chi2_quantile
from lostmotion.identify.actuators.backlash import BACKLASH
from lostmotion.identify.actuators.backlash_family import BacklashFamily
from lostmotion.identify.actuators.kind import GLANCES, Kind, Words, register
from lostmotion.identify.actuators.memory_family import LARGEST, rests_of
from lostmotion.identify.actuators.operator_profile import MOST_STARTS, lags_of
from lostmotion.identify.actuators.polish import FINE_RESTS, LEVEL, polished, profile_end, rested
from lostmotion.identify.actuators.slip_draws import FEWEST_TURNS
from lostmotion.identify.actuators.slip_growth import likelier_slip_of
from lostmotion.identify.actuators.slip_profile import slips_of
from lostmotion.identify.actuators.slip_rivals import rival_places
from lostmotion.identify.actuators.slip_search import slip_intervals, slipped, turns_seen
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.actuators.stiction_family import STICTION_MODELS, RampFamily, StictionFamily, own
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.likelihood.refinement import LocalFit, refine
from lostmotion.identify.likelihood.search import best_fit
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.kernels.stiction import HE
from lostmotion.models import Nonlinearity, Stiction

JUMPS = (0.25, 0.5, 0.8)  # shares of the band with which stiction is begun at backlash
SMALLEST_GLANCE, GLANCED_JUMPS = 0.05, (0.2, 0.8)  # of a first look: in ranges of OP, and in bands
NEEDED_JUMP = 5.0  # by which it must beat backlash: the place of its jump was sought as well
HELD_STEPS = 8  # of everything else at a band
NEEDED_NO_JUMP, SMALLEST_JUMP = 15.0, 0.05  # the same where the jump is less than this share of the band


class StictionKind(Kind):
    """A valve that sticks and slips; without a jump it is backlash."""

    model = Stiction
    family = StictionFamily
    evidence = "memory"
    angular = "always"
    sticks = True
    searched = 7.5
    nests = BACKLASH.name
    anywhere = ("jump",)
    words = Words(
        wider="Stiction of band above",
        plural="sticking valves",
        measure="dead band and stick band together",
        meanings={"band": "S: dead band and stick band", "jump": "J: slip jump"},
        extra="slip jump",
        advice=(
            "Lubricate or repack the valve, check the packing load and the air supply, replace the positioner if it "
            "hunts.",
            "Until then: put the controller in manual to confirm (the swing stops), or use a knocker (`lostmotion "
            "simulate` says whether it helps here); a detuned controller only makes the swing slower.",
        ),
    )

    def forms(self, data: ScaledData) -> list[Family]:
        """Both models of a valve that slips in the rows, and that which slips between them, up to the range of OP."""
        widest = float(np.ptp(data.u))
        forms = [StictionFamily(widest, data.segments, model) for model in STICTION_MODELS]
        return [*forms, RampFamily(widest, data.segments)]

    def of_size(self, problem: Problem, size: float) -> Iterator[tuple[Family, FloatArray]]:
        """With jumps of several sizes, from several places in the band."""
        for rests in rests_of(problem):
            for share in (*JUMPS, 1.0):
                family = StictionFamily(size, problem.segments, STICTION_MODELS[0], rests=rests)
                yield family, np.array([size, share * size])

    def sought(self, data: ScaledData, asked: Asked) -> Sought:
        """Global search over band, jump and first position."""
        places = slips_of(data, lags_of(data, asked))
        best = places[0]
        forms = [own(form).with_rests(best.rests) for form in self.forms(data)]
        family = next(form for form in forms if own(form).code == best.model)
        etas = [np.array([one.band, one.jump]) for one in places if one.model == best.model]
        return Sought(family, etas[:MOST_STARTS], best.squares)

    def glance(self, data: ScaledData) -> list[tuple[Family, FloatArray]]:
        """Bands over the range of OP, with small and large jumps."""
        form, bands = self.forms(data)[0], float(np.ptp(data.u)) * np.geomspace(SMALLEST_GLANCE, LARGEST, GLANCES)
        return [(form, np.array([band, share * band])) for band in bands for share in GLANCED_JUMPS]

    def finished(self, fitted: Fitted) -> Fitted:
        """The best pattern of slips about a fit; of a valve that slips between the rows what is left is its rest."""
        if not isinstance(fitted.problem.family, RampFamily):
            return slipped(fitted)
        fitted = rested(fitted, FINE_RESTS)
        fit = refine(fitted.problem, fitted.fit.theta, fitted.basis)
        return replace(fitted, fit=replace(fit, converged=True))  # along the jump it is flat

    def met(self, fitted: Fitted) -> bool:
        """The valve turns often enough."""
        return _turns(fitted) >= FEWEST_TURNS if isinstance(fitted.problem.family, RampFamily) else turns_seen(fitted)

    def intervals(self, fitted: Fitted, scaling: Scaling) -> dict[str, tuple[float, float]]:
        """All patterns of slips that the record does not reject, and other places that are nearly as likely."""
        if isinstance(fitted.problem.family, RampFamily):
            rise = chi2_quantile(LEVEL, 1) * fitted.variance
            low, high = (scaling.u_scale * profile_end(fitted, 0, sign, rise, _at_band) for sign in (-1.0, 1.0))
            return {"band": (low, high), "jump": (0.0, high)}
        if not turns_seen(fitted):
            return super().intervals(fitted, scaling)
        ends = np.array(list(slip_intervals(fitted).values())).T
        places = np.array([fitted.actuator, *rival_places(fitted)])
        low, high = np.minimum(ends[0], places.min(axis=0)), np.maximum(ends[1], places.max(axis=0))
        return dict(zip(self.family.own, (scaling.u_scale * np.column_stack([low, high])).tolist(), strict=True))

    def actuator(self, values: Mapping[str, float], family: Family) -> Nonlinearity:
        """With the model of the family."""
        return Stiction(values["band"], values["jump"], own(family).model)

    def simplified(self, fitted: Fitted) -> Fitted:
        """Backlash begun at a stiction that was found, with its process, noise and loads.

        Without its jump stiction is backlash, which must not look worse because of its own search.
        """
        problem, family = fitted.problem, own(fitted.problem.family)
        simpler = BacklashFamily(
            family.widest, family.segments, rests=family.rests, load=family.load, loads=family.loads
        )
        problem = replace(problem, family=simpler)
        band, jump = fitted.actuator
        found = []
        for width in (band, band - jump):
            theta = np.delete(fitted.fit.theta, problem.eta_at + 1)
            theta[problem.eta_at] = max(width, 0.0)
            found.append(Fitted(problem, refine(problem, theta, problem.basis), problem.basis))
        return polished(min(found, key=lambda one: one.fit.cost))

    def enriched(self, fitted: Fitted) -> Fitted:
        """Stiction begun at a backlash that was found, with its process, noise and loads, and jumps of several sizes.

        The likelihood of a jump is a needle, which the profile, with a process of its own at every point, can pass by;
        from the process that a backlash has found the search over patterns reaches it.
        """
        problem, family = fitted.problem, fitted.problem.family
        if not isinstance(family, BacklashFamily):
            raise TypeError(f"expected a fit of {self.nests}, got one of {family.kind}; begin at that kind")
        width = float(fitted.actuator[0])
        found = []
        for model in STICTION_MODELS:
            sticking = StictionFamily(
                family.widest, family.segments, model, rests=family.rests, load=family.load, loads=family.loads
            )
            richer = replace(problem, family=sticking)
            for share in JUMPS:
                theta = np.insert(fitted.fit.theta, problem.eta_at + 1, share * width)
                found.append(Fitted(richer, refine(richer, theta, richer.basis), richer.basis))
        return self.finished(min(found, key=lambda one: one.fit.cost))

    def sought_again(self, fitted: Fitted, asked: Asked) -> Fitted | None:
        """Where the search on growing rows finds a likelier valve, with a process of its own."""
        problem, family = fitted.problem, fitted.problem.family
        data = ScaledData(problem.u, problem.y, problem.segments)
        model, jump = HE, 0.0  # a backlash
        if isinstance(family, StictionFamily):
            model, jump = family.code, float(fitted.actuator[1])
        place = likelier_slip_of(data, lags_of(data, asked), model, (float(fitted.actuator[0]), jump), family.rests)
        if place is None:
            return None
        form = next(form for form in self.forms(data) if own(form).code == place.model)
        return self.finished(best_fit(data, form.with_rests(place.rests), [np.array([place.band, place.jump])], asked))

    def handicapped(self, scores: Mapping[str, float], candidates: Mapping[str, Fitted]) -> float:
        """Its jump must pay beside backlash."""
        if self.nests not in scores:
            return scores[self.name]
        band, jump = candidates[self.name].actuator
        return scores[self.name] - (NEEDED_NO_JUMP if jump < SMALLEST_JUMP * band else NEEDED_JUMP)


def _at_band(fitted: Fitted, start: LocalFit, index: int, value: float) -> LocalFit | None:
    """Best fit of a valve that slips between the rows with its band at a value; None outside the valid set."""
    at, theta = fitted.problem.eta_at + index, start.theta.copy()
    theta[at] = value
    moved = fitted.problem.project(theta)
    if moved[at] != value:
        return None
    return refine(fitted.problem, moved, fitted.problem.free_but([at], fitted.basis), most_steps=HELD_STEPS, tied=True)


def _turns(fitted: Fitted) -> int:
    """How often a valve that slips between the rows turns."""
    x = np.empty(fitted.problem.u.size)
    fitted.problem.family.path(fitted.actuator, fitted.problem.u, x)
    moves = np.sign(np.diff(x))
    moves = moves[moves != 0.0]
    return int(np.count_nonzero(moves[1:] != moves[:-1]))


STICTION = register(StictionKind())
