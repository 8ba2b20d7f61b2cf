"""One call of ``identify``: its data and settings, and the result of a fit of it in engineering units."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from lostmotion.errors import Status
from lostmotion.identify.actuators.actuator_lag import NO_LAG
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.earned import earned
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.in_units import chosen_of, fit_percent_of, model_of, on_rows
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.misfit import residual_tests
from lostmotion.identify.likelihood.parameters import name_parameters, with_profiled
from lostmotion.identify.likelihood.simulated import simulated_output
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.identify.status import decide, excluded_above, weigh
from lostmotion.models import NoiseModel


@dataclass(frozen=True)
class Call:
    """Checked data, what is asked, settings as given, and whether kinds are compared.

    `sound`: lost motion in units of OP that is no fault; None: nobody asks.
    """

    data: IdentificationData
    asked: Asked
    settings: dict[str, Any]
    compared: bool = True
    sound: float | None = None

    @cached_property
    def scaled(self) -> ScaledData:
        """The data as the likelihood wants them."""
        data = self.data
        return ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))

    def packed(
        self,
        fitted: Fitted,
        linear: Fitted,
        predicting: Fitted | None = None,
        interval: tuple[float, float] | None = None,
        answered: float | None = None,
    ) -> HammersteinFit:
        """Result in engineering units with status.

        `predicting`: the linear model with noise, where these have none. `interval`: of the size, scaled, and
        `answered`: gain of the linear model over none, where they are known.
        """
        data, scaled, family = self.data, self.scaled, fitted.problem.family
        scaling, kind, s = scaled.scaling, kind_of(family.kind), fitted.problem.structure
        lag = kind.lag(fitted) if self.compared and interval is None else NO_LAG  # who is not compared has none
        named = name_parameters(lag.shown(fitted), scaling, self.settings["gain"] if kind.has_slopes else None)
        if interval is None:
            profiled = lag.joined(kind.intervals(fitted, scaling), scaling.u_scale)
        else:
            low, high = (scaling.u_scale * end for end in interval)
            profiled = {} if kind.size is None else {kind.size: (low, high)}
        covariance = with_profiled(named, profiled)
        simulated, errors = simulated_output(fitted), fitted.problem.predict(fitted.fit.theta)[1]
        evidence = weigh(scaled, fitted, linear, named.values, data, self.asked, predicting or linear)
        evidence = replace(evidence, actuator_lag=lag.rows * data.dt)
        if answered is not None:
            evidence = replace(evidence, gain_over_no_input=answered, load_drifts=True, answered=True)
        tests = residual_tests(fitted, errors)
        rows, percent = on_rows(simulated, scaled, s.first), fit_percent_of(scaled, simulated, s.first)
        status = decide(fitted, evidence, tests.coloured, tests.misfit, named.values, covariance, profiled)
        status = earned(status, fitted, evidence, data, named.values, rows, percent)
        variance = fitted.variance / fitted.dispersion
        return HammersteinFit(
            status=status,
            model=model_of(named.values, fitted, data),
            noise=NoiseModel(tuple(fitted.parts.d), variance * scaling.y_scale**2, s.zero, s.c),
            parameters=named.values,
            covariance=covariance,
            residuals=np.concatenate(errors) * scaling.y_scale,
            simulated=rows,
            fit_percent=percent,
            tests=tests,
            evidence=evidence,
            widest=None if status is not Status.NOT_SEEN else excluded_above(fitted, evidence, profiled, scaling),
            profiled=profiled,
            settings={**self.settings, "offset_fixed": fitted.basis is not None},
            chosen=chosen_of(fitted, scaling),
            data=data,
        )
