"""HammersteinFit: what an identification found, how sure it is, and on what."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

from lostmotion import _verbs
from lostmotion.actuator import ActuatorResponse
from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.facts import FitFacts
from lostmotion.identify.likelihood.misfit import ResidualTests
from lostmotion.identify.rated_estimate import RatedEstimate
from lostmotion.models import Hammerstein, NoiseModel


@dataclass(frozen=True, eq=False, repr=False)
class HammersteinFit(RatedEstimate):
    """Result of :func:`identify`. Frozen; prints, draws and writes itself.

    Attributes
    ----------
    status : Status
        Outcome; its value is a sentence with the remedy.
    model : Hammerstein
        Actuator, process and offset in engineering units.
    noise : NoiseModel
        Output noise.
    parameters : dict of float
        Named parameters: left, right, left_slope, right_slope, width, slope_ratio, gain, offset, a1 .., b0 ...
        With an unknown gain right_slope is 1 by convention and the gain stays in the linear part.
    covariance : ndarray, shape (len(parameters), len(parameters))
        Covariance in the order of `parameters`, from the Fisher information (noise model, offset and initial
        states included). width, slope_ratio and gain depend on the others, so it is singular.
    widest : float or None
        Where no lost motion is seen: the widest that the record does not exclude (95 %, profile likelihood).
    profiled : dict of (float, float)
        95 % intervals from the profile likelihood, of parameters whose likelihood has jumps (backlash, stiction).
    chosen : Chosen
        Structure of the model: orders, delay, noise order, whether it integrates, loads beside the actuator.
    kinds : KindChoice or None
        With nonlinearity="auto": how the kinds compare, and how sure the choice is.
    linear_alternative : HammersteinFit or None
        Where no number is given for the fault: the linear model, whose gain is that of the process.
    actuator : ActuatorResponse or None
        Where the record has the actuator's position: what that shows (:func:`lostmotion.actuator_response`).
    residuals : ndarray
        Prediction errors, white where the model is right; simulated : output of the model from its input alone.
    """

    status: Status
    model: Hammerstein
    noise: NoiseModel
    parameters: dict[str, float]
    covariance: FloatArray
    residuals: FloatArray
    simulated: FloatArray
    fit_percent: float
    tests: ResidualTests
    evidence: Evidence
    settings: dict[str, Any]
    chosen: Chosen
    widest: float | None
    data: IdentificationData = field(repr=False)
    linear_alternative: HammersteinFit | None = field(default=None, repr=False)
    profiled: dict[str, tuple[float, float]] = field(default_factory=dict)
    kinds: KindChoice | None = None
    actuator: ActuatorResponse | None = None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return self.found_in_words, self.status.name, f"{self.data.u.size} samples"

    @property
    def facts(self) -> FitFacts:
        """What others need to know of this fit, without its signals; :func:`lostmotion.read_fit` gives the same."""
        data = self.data
        return FitFacts(
            status=self.status,
            model=self.model,
            noise=self.noise,
            parameters=self.parameters,
            covariance=self.covariance,
            fit_percent=self.fit_percent,
            evidence=self.evidence,
            widest=self.widest,
            chosen=self.chosen,
            known_gain=self.settings["gain"],
            op_range=(float(data.u.min()), float(data.u.max())),
            op_span=data.op_span,
            op_noise=data.u_noise,
            dt=data.dt,
            samples=int(data.u.size),
            tag=data.tag,
            source=data.source,
            fingerprint=data.fingerprint,
            profiled=self.profiled,
            kinds=self.kinds,
            made_up=data.drawn,
        )

    @property
    def least_known(self) -> float:
        """Lower end of the size, 95 %, without moves of OP that may or may not be between the rows."""
        known = self.evidence.unseen_moves if self.data.unseen.moves > 0.0 else 0.0
        return self._interval(str(self.kind.size), 0.95, known)[0]

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences about the data in the light of the fit: resolution, sampling, % of span."""
        return _verbs.remarks(self)

    def plot(self, **options: Any) -> Any:
        """Figure: trend of PV and OP with the model, valve, process, residuals; what was found stands above.

        ``figure=`` draws into a matplotlib Figure or SubFigure (about 8 x 6 inches or more) instead of a new one,
        ``ax=`` the characteristic of the valve alone into an Axes, best of a figure with ``layout="constrained"``;
        ``title=`` replaces the heading. Needs the extra ``lostmotion[plot]``; returns the matplotlib Figure.

        Raises
        ------
        ParameterError
            Both `figure` and `ax`.
        """
        return _verbs.plot(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Infinite numbers become None."""
        facts, data = self.facts.to_dict(), self.data
        about = {"segments": data.segments.tolist(), "notes": list(data.notes), "remarks": list(self.remarks)}
        return {
            **facts,
            **({} if self.actuator is None else {"actuator": self.actuator.to_dict()}),
            "residual_tests": dict(vars(self.tests)),
            "settings": {**copy.deepcopy(self.settings), "chosen": self.chosen.to_dict()},
            "data": {**facts["data"], **about},
        }
