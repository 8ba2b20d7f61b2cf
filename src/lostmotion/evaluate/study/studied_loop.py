"""What is known of the loop: the model, its noise, how sure they are, and where OP was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion.arguments import finite
from lostmotion.arrays import FloatArray
from lostmotion.compensate.gate import Said, pass_gate
from lostmotion.errors import DataError, GateError, ParameterError, Status
from lostmotion.evaluate.study.faults import REMEDY, WANTED, NoFault, fault_of
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.identify import FitFacts, RatedEstimate, RecursiveEstimate, facts_of
from lostmotion.models import Hammerstein, NoiseModel


@dataclass(frozen=True)
class Known:
    """A plant, its noise, and the uncertainty of both.

    Attributes
    ----------
    plant : StudyPlant
    noise : NoiseModel
    parameters, covariance : dict of float and ndarray
        Of a fit, in one order; both empty where the model was given by numbers.
    op_range : (float, float) or None
        Of the record.
    source : str
        Where the model comes from, in words.
    facts : FitFacts or None
        The fit.
    accepted : str
        Reason for which a closed gate was passed.
    """

    plant: StudyPlant
    noise: NoiseModel
    parameters: dict[str, float] = field(default_factory=dict)
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    op_range: tuple[float, float] | None = None
    source: str = "a model given by numbers"
    facts: FitFacts | None = None
    accepted: str = ""

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors that are known."""
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        found = zip(self.parameters, deviations.tolist(), strict=True)
        return {name: error for name, error in found if np.isfinite(error)}


def known(
    model: Hammerstein | RatedEstimate | RecursiveEstimate | Mapping[str, Any],
    noise: NoiseModel | float | None,
    diagnosis: Said | None = None,
    accept: str | None = None,
) -> Known:
    """From a fit, facts or the dictionary of a fit, an estimate in service, or a model with its noise.

    Raises
    ------
    ParameterError
        An actuator without lost motion, noise beside a fit, or a model without noise.
    GateError
        A fit that shows no lost motion, or a diagnosis that says something else, and no reason to accept it; an
        estimate in service that is not OK.
    DataError
        A dictionary of something else.
    """
    if isinstance(model, Hammerstein):
        if isinstance(fault_of(model.nonlinearity), NoFault):
            raise ParameterError.expected(WANTED, model.nonlinearity.kind, REMEDY)
        if noise is None:
            raise ParameterError.expected("the noise beside a model", None, "give its variance, 0 for none")
        made = noise if isinstance(noise, NoiseModel) else NoiseModel((), finite("noise variance", noise))
        return Known(StudyPlant(model), made)
    if noise is not None:
        raise ParameterError.expected("a fit alone", "a fit and noise", "the fit has its own noise model")
    if isinstance(model, RecursiveEstimate):
        return _from_service(model)
    return _from_fit(facts_of(model), diagnosis, accept)


def _from_service(estimate: RecursiveEstimate) -> Known:
    if estimate.status is not Status.OK or estimate.noise is None:
        raise GateError.expected("an estimate in service of status OK", estimate.status.name, estimate.status.value)
    source = f"an estimate in service after {estimate.samples} samples, status {estimate.status.name}"
    return Known(StudyPlant(estimate.model), estimate.noise, estimate.parameters, estimate.covariance, source=source)


def _from_fit(facts: FitFacts, diagnosis: Said | None, accept: str | None) -> Known:
    accepted = pass_gate(facts, diagnosis, accept)
    if facts.kind.size is None:
        raise DataError.expected(WANTED, facts.kind.name, REMEDY)
    return Known(
        StudyPlant(facts.model, _load(facts)),
        facts.noise,
        facts.parameters,
        facts.covariance,
        facts.op_range,
        f"a fit of {facts.samples} samples{' of ' + facts.tag if facts.tag else ''}, status {facts.status.name}",
        facts,
        accepted,
    )


def _load(facts: FitFacts) -> float:
    """Load of an integrating process: as fitted, or such that OP rests in the middle of its range."""
    if not facts.linear.integrates():
        return 0.0
    if "load" in facts.parameters:
        return facts.parameters["load"] * facts.parameters.get("right_slope", 1.0)
    return 0.0 if fault_of(facts.nonlinearity).static else -0.5 * sum(facts.op_range)
