"""What is known before the test: a guess, or a fit with its covariance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lostmotion.arguments import finite
from lostmotion.arrays import FloatArray
from lostmotion.compensate.gate import Said, pass_dead_zone
from lostmotion.design.plausible_plants import around_guess, drawn, drawn_around_guess, extremes
from lostmotion.errors import ParameterError
from lostmotion.identify import FitFacts, RatedEstimate, facts_of
from lostmotion.models import DeadZone, Hammerstein, NoiseModel

GUESS = (
    "the guess with its break points moved by up to {0:.0f} % of the half-width, slopes, gain and time constants by "
    "{0:.0f} %"
)
FIT = "drawn from the covariance of the fit"
BREAK_POINTS = ("left", "right")


@dataclass(frozen=True)
class Known:
    """A model, its noise, and how rough it is.

    Parameters
    ----------
    model : Hammerstein
        With a :class:`DeadZone`.
    noise : NoiseModel
    parameters, covariance : dict of float and ndarray, or None
        Of a fit, in one order. None: the model is a guess.
    spread : float
        Of a guess.
    load : float or None
        What an integrating process of a fit is given behind its actuator, in units of x.
    accepted : str
        Reason for which a closed gate was passed.
    """

    model: Hammerstein
    noise: NoiseModel
    parameters: dict[str, float] | None = None
    covariance: FloatArray | None = None
    spread: float = 0.3
    load: float | None = None
    accepted: str = ""

    @property
    def roughness(self) -> str:
        """Where the plausible plants come from, in words."""
        return GUESS.format(100 * self.spread) if self.covariance is None else FIT

    def better(self, times: float) -> Known:
        """The same, known so many times better."""
        covariance = None if self.covariance is None else self.covariance / times**2
        return replace(self, covariance=covariance, spread=self.spread / times)

    def plausible(self, count: int, seed: int) -> list[Hammerstein]:
        """Models for the search."""
        if self.covariance is None or self.parameters is None:
            return around_guess(self.model, count, seed, self.spread)
        return drawn(self.model, self.parameters, self.covariance, count, seed)

    def fresh(self, count: int, seed: int) -> list[Hammerstein]:
        """Models that the search has not seen."""
        if self.covariance is None or self.parameters is None:
            return drawn_around_guess(self.model, count, seed, self.spread)
        return drawn(self.model, self.parameters, self.covariance, count, seed + 1)

    def extremes(self) -> list[Hammerstein]:
        """Models that go furthest in PV; for a fit the fresh ones do."""
        return extremes(self.model, self.spread) if self.covariance is None else []


def known(
    model: Hammerstein | RatedEstimate | Mapping[str, Any],
    noise: NoiseModel | float | None,
    spread: float,
    diagnosis: Said | None = None,
    accept: str | None = None,
) -> Known:
    """From what the caller has: a model and its noise, a fit, or the dictionary of a fit.

    Raises
    ------
    ParameterError
        No noise beside a model, or noise beside a fit; an actuator that is not a dead zone.
    GateError
        A fit that shows no dead zone, or a diagnosis that says something else, and no reason to accept it.
    """
    if isinstance(model, Hammerstein):
        if not isinstance(model.nonlinearity, DeadZone):
            kind = type(model.nonlinearity).__name__
            raise ParameterError.expected("a DeadZone actuator", kind, "other kinds have no test design yet")
        if not 0 < model.nonlinearity.width < np.inf:
            raise ParameterError.expected("a dead zone with a width", model.nonlinearity.width, "give your best guess")
        return Known(model, _noise(noise), spread=spread)
    if noise is not None:
        raise ParameterError.expected("a fit alone", "a fit and noise", "the fit has its own noise model")
    return _from_fit(facts_of(model), diagnosis, accept)


def _noise(noise: NoiseModel | float | None) -> NoiseModel:
    if noise is None:
        remedy = "give the variance of PV at rest or a NoiseModel; without it no interval can be predicted"
        raise ParameterError.expected("the noise beside a model", None, remedy)
    noise = noise.autoregression() if isinstance(noise, NoiseModel) else NoiseModel((), finite("noise variance", noise))
    if not noise.variance > 0:
        raise ParameterError.expected("noise variance > 0", noise.variance, "without noise every test is perfect")
    if noise.radius >= 1.0:
        raise ParameterError.expected("stationary noise", f"d={noise.d}", "its poles must lie inside the unit circle")
    return noise


def _from_fit(facts: FitFacts, diagnosis: Said | None, accept: str | None) -> Known:
    accepted = pass_dead_zone(facts, diagnosis, accept, "give a model with your guess of the break points instead")
    noise, load = _noise(facts.noise), facts.parameters.get("load")
    covariance = facts.covariance
    known_rows = dict(zip(facts.parameters, np.isfinite(np.diag(covariance)), strict=True))
    if not all(known_rows[name] for name in BREAK_POINTS):
        return Known(facts.model, noise, load=load, accepted=accepted)
    covariance = np.where(np.isfinite(covariance), covariance, 0.0)
    return Known(facts.model, noise, facts.parameters, covariance, load=load, accepted=accepted)
