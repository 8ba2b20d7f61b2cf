"""Can a record tell its fault at all? The likelihood of the true kind, sought from the true actuator."""

from __future__ import annotations

import numpy as np

import lostmotion as lm
from lostmotion.evaluate.random_faults import REST, FaultyLoop
from lostmotion.identify.actuators.choice import likelihood_gain
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.actuators.fit_kind import fit_linear
from lostmotion.identify.actuators.kind import NEEDED, kind_of
from lostmotion.identify.actuators.loads import with_own_loads, without_actuator
from lostmotion.identify.actuators.polish import polished
from lostmotion.identify.data import FEWEST_SAMPLES, collect
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import gain_over_linear
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.search import best_fit
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.models import Backlash, DeadZone, Saturation, Stiction
from lostmotion.records import prepare


def told(loop: FaultyLoop) -> bool:
    """Whether the true kind, begun at its true parameters, beats the linear model as a verdict must.

    No search can know more than one that is told the answer, but for luck: where this one gains nothing, the record
    does not hold the fault.
    """
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    data = collect(prepare(record), None, None, False, FEWEST_SAMPLES)
    scaled = ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))
    family, eta = _truth(loop, scaled, data.u_centre, data.u_scale)
    linear = with_own_loads(fit_linear(scaled, Asked()))
    best = best_fit(scaled, family, [family.project(eta)], Asked())
    if family.kinks:
        best = polished(best)
    best = with_own_loads(best)
    linear = max(linear, without_actuator(best), key=lambda one: gain_over_linear(one, linear))
    return bool(likelihood_gain(best, linear)[1] > NEEDED)


def _truth(loop: FaultyLoop, scaled: ScaledData, centre: float, scale: float) -> tuple[Family, np.ndarray]:
    """Family and true parameters in scaled units."""
    valve = loop.actuator
    if isinstance(valve, DeadZone):
        ends = (np.array([valve.left, valve.right]) + REST - centre) / scale
        return DeadZoneFamily(float(scaled.u.min()), float(scaled.u.max())), np.array([*ends, 0.0])
    if isinstance(valve, Backlash):
        return kind_of("backlash").forms(scaled)[0], np.array([valve.width / scale])
    if isinstance(valve, Stiction):
        own = next(one for one in kind_of("stiction").forms(scaled) if getattr(one, "model", "") == valve.model)
        return own, np.array([valve.band, valve.jump]) / scale
    assert isinstance(valve, Saturation)
    return kind_of("saturation").forms(scaled)[0], (np.array([valve.low, valve.high]) + REST - centre) / scale
