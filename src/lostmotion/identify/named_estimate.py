"""What every estimate offers, batch or recursive: named parameters with standard errors and intervals."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.distributions import normal_quantile
from lostmotion.errors import ParameterError
from lostmotion.models import Hammerstein, LinearModel, Nonlinearity


class NamedEstimate:
    """Base of results that hold a model, named parameters and their covariance in the same order."""

    model: Hammerstein
    parameters: dict[str, float]
    covariance: FloatArray

    @property
    def nonlinearity(self) -> Nonlinearity:
        """Actuator model."""
        return self.model.nonlinearity

    @property
    def linear(self) -> LinearModel:
        """Linear part."""
        return self.model.linear

    @property
    def standard_errors(self) -> dict[str, float]:
        """One standard error of each parameter, same keys as `parameters`; infinite where not known."""
        errors = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return dict(zip(self.parameters, errors.tolist(), strict=True))

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval of a parameter.

        Parameters
        ----------
        name : str
            Key of `parameters`.
        level : float
            Confidence in (0, 1).

        Raises
        ------
        ParameterError
            Unknown name or a level outside (0, 1).
        """
        if name not in self.parameters:
            raise ParameterError.expected(f"one of {list(self.parameters)}", repr(name), "see fit.parameters")
        if not 0 < level < 1:
            raise ParameterError.expected("0 < level < 1", level, "0.95 is usual")
        reach = normal_quantile(0.5 + level / 2) * self.standard_errors[name]
        return self.parameters[name] - reach, self.parameters[name] + reach
