"""A diagnosis for tests of what shows it: a simulated loop, a quick fit, and any verdict."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

import lostmotion as lm
from lostmotion.diagnose.diagnosis import Item
from lostmotion.diagnose.features import measure
from lostmotion.diagnose.loop_stability import LoopStability
from lostmotion.diagnose.performance import Performance
from lostmotion.identify.actuators.choice import KindChoice

KINDS = {  # where each verdict can come from
    "none": ("none",),
    "dead zone": ("actuator",),
    "backlash": ("actuator",),
    "stiction": ("actuator",),
    "saturation": ("actuator",),
    "other oscillation": ("tuning", "disturbance", "sensor", "unknown"),
    "cannot tell": ("unknown",),
}
CASES = [(verdict, kind) for verdict, kinds in KINDS.items() for kind in kinds]
GAINS = {"none": 0.0, "dead zone": 40.0, "stiction": 120.4, "backlash": 90.0}


def loop_record(samples: int = 400, **known: object) -> lm.LoopRecord:
    """A flow loop whose valve has a dead zone of 4 % of span."""
    plant = lm.Hammerstein(lm.DeadZone(-2.0, 2.0), lm.LinearModel([-0.8], [0.2], 1))
    sp = np.where(np.arange(samples) // 25 % 2, 3.0, -3.0)
    loop = lm.simulate_loop(plant, lm.PI(0.4, 0.15), sp, noise=0.02, seed=3)
    return lm.LoopRecord(50 + loop.control, 50 + loop.measured, 50 + sp, dt=5.0, tag="FC7", **known)


@cache
def example() -> lm.Diagnosis:
    """Dead zone of a fit with given orders; evidence and probabilities are made up."""
    record = loop_record()
    fit = lm.identify(record, raw=True, orders=(1, 0, 1), noise="white", nonlinearity="dead zone")
    fit = replace(fit, kinds=KindChoice("stiction", GAINS, GAINS, GAINS, 0.99, "backlash"))
    width = fit.parameters["width"]
    return lm.Diagnosis(
        verdict="dead zone",
        kind="actuator",
        severity="high",
        size=width,
        interval=fit.interval("width"),
        size_percent=width,
        confidence=0.93,
        probabilities={"none": 0.07, "actuator": 0.93},
        evidence=(
            Item("dead_zone", 3.71, 5.2, "in words"),
            Item("shape", -0.31, -1.2, "in words"),
        ),
        advice=("Check the range.", "Compensate."),
        notes=("The OP span was taken as 0 .. 100; give op_span where it is not.",),
        measured=measure(fit),
        stability=LoopStability(0.4, 0.15, 0.001, 0.4, 22.0),
        performance=Performance(0.25, (0.3, 0.6), 1234.5, 144.0, 0.0, 0.01, "fair", "flow"),
        fit=fit,
        record=record,
    )


def variant(verdict: str, kind: str, **changes: object) -> lm.Diagnosis:
    """The same with another verdict; only lost motion has a size."""
    sized = verdict in ("dead zone", "backlash", "stiction")
    nothing = {"size": np.nan, "interval": (np.nan, np.nan), "size_percent": np.nan, "severity": "none"}
    if verdict in ("none", "other oscillation"):
        nothing |= {"excluded": {"dead zone": 0.6, "backlash": 0.2, "stiction": 0.31}, "tolerance": 1.0}
    return replace(example(), verdict=verdict, kind=kind, **({} if sized else nothing) | changes)
