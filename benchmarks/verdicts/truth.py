"""Can a record tell its fault at all? The likelihood of the true kind, sought from the true actuator."""

from __future__ import annotations

import numpy as np

import lostmotion as lm
from lostmotion.evaluate.random_faults import REST, FaultyLoop
from lostmotion.identify.actuators.choice import NEEDED, likelihood_gain
from lostmotion.identify.actuators.kinds import families, fit_kind
from lostmotion.identify.actuators.loads import with_own_loads, without_actuator
from lostmotion.identify.actuators.polish import polished
from lostmotion.identify.data import FEWEST_SAMPLES, collect
from lostmotion.identify.evidence import gain_over_linear
from lostmotion.identify.likelihood.family import DeadZoneFamily, Family
from lostmotion.identify.likelihood.search import ScaledData, best_fit
from lostmotion.models import Backlash, DeadZone, Saturation, Stiction
from lostmotion.records import prepare


def told(loop: FaultyLoop) -> bool:
    """Whether the true kind, begun at its true parameters, beats the linear model as a verdict must.

    No search can know more than one that is told the answer, but for luck: where this one gains nothing, the record
    does not hold the fault.
    """
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    data = collect(prepare(record), None, None, False, FEWEST_SAMPLES)
    scaled = ScaledData((data.u - data.u_centre) / data.u_scale, (data.y - data.y_centre) / data.y_scale, data.segments)
    family, eta = _truth(loop, scaled, data.u_centre, data.u_scale)
    linear = with_own_loads(fit_kind(None, scaled, None, None, levels=True))
    best = best_fit(scaled, family, [family.project(eta)], None, None)
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
        return families("backlash", scaled)[0], np.array([valve.width / scale])
    if isinstance(valve, Stiction):
        own = next(one for one in families("stiction", scaled) if getattr(one, "model", "") == valve.model)
        return own, np.array([valve.band, valve.jump]) / scale
    assert isinstance(valve, Saturation)
    return families("saturation", scaled)[0], (np.array([valve.low, valve.high]) + REST - centre) / scale
