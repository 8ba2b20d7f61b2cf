"""Stiction: a valve that rests until OP has gone far enough, then jumps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.backlash import BACKLASH, BacklashFamily
from lostmotion.identify.actuators.kind import Kind, Words, register
from lostmotion.identify.actuators.memory_family import LARGEST, SMALLEST, MemoryFamily
from lostmotion.identify.actuators.polish import polished
from lostmotion.identify.likelihood.family import Family, Grid
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.scaled import ScaledData
from lostmotion.kernels import stiction as kernel
from lostmotion.models import Nonlinearity, Stiction
from lostmotion.models.stiction import CODES

STICTION_MODELS = ("kano", "he")  # Choudhury's never moves under noise inside its band
LARGEST_JUMP = 3.0  # bands: a slip beyond this is not a valve
JUMPS = (0.25, 0.5, 0.8)  # shares of the band with which stiction is begun at backlash
FINE_GRID = 130  # bands, 3.5 % apart: a break-away must be in its sample
GRID_ROWS = 2000  # of a record for which that is enough; the more break-aways, the narrower the peak
FIRST_SHARES = (0.15, 0.5, 1.0)  # jump over band
# jump over band around FIRST_SHARES, from near backlash (0.03) to beyond the band (1.3)
SHARES = (0.03, 0.15, 0.3, 0.5, 0.75, 1.0, 1.3)
NEEDED_JUMP = 5.0  # by which it must beat backlash: the place of its jump was sought as well
NEEDED_NO_JUMP, SMALLEST_JUMP = 15.0, 0.05  # the same where the jump is less than this share of the band


@dataclass(frozen=True)
class StictionFamily(MemoryFamily):
    """Stiction; eta = band, jump with band in [0, widest] and jump in [0, 3 band]."""

    model: str = "kano"
    kind: ClassVar[str] = "stiction"
    own: ClassVar[tuple[str, ...]] = ("band", "jump")

    def act(self, eta: FloatArray, u: FloatArray, x: FloatArray, dx: FloatArray) -> None:
        """Position from rest at the first command of each segment."""
        for start, stop, rest in self.begun():
            part, slopes = np.empty(stop - start), np.empty((2, stop - start))
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            kernel.sensitivities(CODES[self.model], u[start:stop], eta[0], eta[1], position, part, slopes)
            x[start:stop], dx[:2, start:stop] = part, slopes

    def path(self, eta: FloatArray, u: FloatArray, x: FloatArray) -> None:
        """The position alone."""
        for start, stop, rest in self.begun():
            position = u[start] + 0.5 * rest * (eta[0] + eta[1])
            x[start:stop] = kernel.run(CODES[self.model], u[start:stop], eta[0], eta[1], position)

    def valid(self, eta: FloatArray) -> FloatArray:
        """Band and jump in their range."""
        band = min(max(eta[0], 0.0), self.widest)
        return np.array([band, min(max(eta[1], 0.0), LARGEST_JUMP * band)])

    def grid(self, u: FloatArray, span: float, rows: int) -> Grid:
        """By the band, which sets when the valve breaks away after a turn, and the jump, which sets how far it goes."""
        del u
        bands = span * np.geomspace(SMALLEST, LARGEST, round(FINE_GRID * max(rows / GRID_ROWS, 1.0) ** 1.5))
        ratio = (bands[1] / bands[0]) ** np.linspace(-1.0, 1.0, 5)

        def finer(eta: FloatArray) -> list[FloatArray]:
            return [step * eta[0] * np.array([1.0, share]) for step in ratio for share in SHARES]

        return [band * np.array([1.0, share]) for band in bands for share in FIRST_SHARES], finer


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
        """Both models, up to the range of OP."""
        widest = float(np.ptp(data.u))
        return [StictionFamily(widest, data.segments, model) for model in STICTION_MODELS]

    def actuator(self, values: Mapping[str, float], family: Family) -> Nonlinearity:
        """With the model of the family."""
        return Stiction(values["band"], values["jump"], _own(family).model)

    def simplified(self, fitted: Fitted) -> Fitted:
        """Backlash begun at a stiction that was found, with its process, noise and loads.

        Without its jump stiction is backlash, which must not look worse because of its own search.
        """
        problem, family = fitted.problem, _own(fitted.problem.family)
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
        from the process that a backlash has found the pattern search reaches it.
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
                found.append(polished(Fitted(richer, refine(richer, theta, richer.basis), richer.basis)))
        return min(found, key=lambda one: one.fit.cost)

    def handicapped(self, scores: Mapping[str, float], candidates: Mapping[str, Fitted]) -> float:
        """Its jump must pay beside backlash."""
        if self.nests not in scores:
            return scores[self.name]
        band, jump = candidates[self.name].actuator
        return scores[self.name] - (NEEDED_NO_JUMP if jump < SMALLEST_JUMP * band else NEEDED_JUMP)


def _own(family: Family) -> StictionFamily:
    if not isinstance(family, StictionFamily):
        raise TypeError(f"expected a family of stiction, got one of {family.kind}; ask its own kind")
    return family


STICTION = register(StictionKind())
