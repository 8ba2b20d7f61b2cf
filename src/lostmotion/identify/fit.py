"""HammersteinFit: what an identification found, how sure it is, and on what."""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.arrays import FloatArray
from lostmotion.distributions import normal_quantile
from lostmotion.errors import Status
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.actuators.kind import Kind, kind_of
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.likelihood.misfit import ResidualTests
from lostmotion.identify.named_estimate import NamedEstimate
from lostmotion.models import Hammerstein, NoiseModel

POSITIVE = ("left_slope", "right_slope", "slope_ratio")
EVEN_ODDS = 6.0  # BIC behind: another maximum that is less unlikely than 1 to 20 belongs into the interval


@dataclass(frozen=True, eq=False)
class HammersteinFit(NamedEstimate):
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

    @property
    def kind(self) -> Kind:
        """All that is known of the kind of the actuator that was fitted."""
        return kind_of(self.nonlinearity.kind)

    @property
    def preferred(self) -> str:
        """What the record supports: this kind, "none" (a linear model does as well), or "cannot tell"."""
        if self.status is Status.NOT_SEEN:
            return "none"
        return self.nonlinearity.kind if self.status.ok or self.status is Status.COLOURED else "cannot tell"

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval of a parameter.

        Parameters
        ----------
        name : str
            Key of `parameters`.
        level : float
            Confidence in (0, 1).

        Returns
        -------
        (float, float)
            Lower and upper end, on a logarithmic scale for slopes. Where no dead zone is seen its break points
            and slope ratio can be anywhere, so their interval is the whole line; that of the width begins at 0.
            Other dead zones that fit about as well (`evidence.rivals`, less than 6 of BIC behind) lie inside.

        Raises
        ------
        ParameterError
            Unknown name or a level outside (0, 1).
        """
        low, high = super().interval(name, level)
        if name in self.profiled:  # asymmetric; other levels in proportion
            share = normal_quantile(0.5 + level / 2) / normal_quantile(0.975)
            value, ends = self.parameters[name], self.profiled[name]
            low, high = value - share * (value - ends[0]), value + share * (ends[1] - value)
        low, high = self._with_rivals(name, low, high)
        if name == "width":
            low = max(low, 0.0)
        if name in POSITIVE and self.parameters[name] > 0:
            factor = np.exp((high - low) / (2.0 * self.parameters[name]))
            low, high = self.parameters[name] / factor, self.parameters[name] * factor
        if self.status in (Status.NOT_SEEN, Status.CANNOT_TELL):
            if name == self.kind.size:
                return 0.0, max(high, 0.0) if self.widest is None else self.widest
            if name in self.kind.anywhere:
                return -np.inf, np.inf
        if self.status is Status.ONE_SIDED and name in self.unvisited:
            return (0.0, np.inf) if name == "width" else (-np.inf, np.inf)
        return low, high

    def _with_rivals(self, name: str, low: float, high: float) -> tuple[float, float]:
        """Interval that holds the other dead zones which fit about as well."""
        for left, right, behind in self.evidence.rivals:
            other = {"left": left, "right": right, "width": right - left}
            if behind < EVEN_ODDS and name in other:
                low, high = min(low, other[name]), max(high, other[name])
        return low, high

    @property
    def unvisited(self) -> tuple[str, ...]:
        """Parameters of a side on which OP has hardly been (status ONE_SIDED), and what hangs on them."""
        return self.kind.unvisited(self.evidence) if self.status is Status.ONE_SIDED else ()

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences about the data in the light of the fit: resolution, sampling, % of span."""
        return _verbs.remarks(self)

    def summary(self) -> str:
        """Report as text, with as many digits as the standard errors allow."""
        return _verbs.summary(self)

    def plot(self, **options: Any) -> Any:
        """Figure: characteristic, step response, measured against simulated, residual correlations.

        Needs the extra ``lostmotion[plot]``; returns a matplotlib Figure.
        """
        return _verbs.plot(self, **options)

    def compensator(self, **options: Any) -> Any:
        """Ideal inverse of the dead zone or backlash; see :class:`lostmotion.compensate.DeadZoneCompensator`.

        What is fit for a PLC, with the uncertainty of this fit in its settings, is :meth:`block`.
        """
        return _verbs.compensator(self.nonlinearity, **options)

    def block(self, **options: Any) -> Any:
        """Compensating block with safeguards; see :func:`lostmotion.compensate.block_from_fit`."""
        return _verbs.block(self, **options)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: everything but the signals. Infinite numbers become None."""
        data = self.data
        return {
            "status": self.status.name,
            "message": self.status.value,
            "preferred": self.preferred,
            "model": self.model.to_dict(),
            "noise": self.noise.to_dict(),
            "parameters": {name: _finite(value) for name, value in self.parameters.items()},
            "standard_errors": {name: _finite(value) for name, value in self.standard_errors.items()},
            "covariance": [[_finite(value) for value in row] for row in self.covariance],
            "intervals_95": {name: [_finite(end) for end in self.interval(name)] for name in self.parameters},
            "fit_percent": self.fit_percent,
            "widest": None if self.widest is None else _finite(self.widest),
            "evidence": dict(vars(self.evidence)),
            "residual_tests": dict(vars(self.tests)),
            "kinds": None if self.kinds is None else self.kinds.to_dict(),
            "settings": {**copy.deepcopy(self.settings), "chosen": self.chosen.to_dict()},
            "data": {
                "tag": data.tag,
                "source": data.source,
                "samples": int(data.u.size),
                "op_range": [float(data.u.min()), float(data.u.max())],
                "segments": data.segments.tolist(),
                "dt": data.dt,
                "fingerprint": data.fingerprint,
                "notes": list(data.notes),
                "remarks": list(self.remarks),
            },
        }

    def __str__(self) -> str:
        return self.summary()


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
