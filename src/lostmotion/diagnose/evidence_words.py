"""Names of the evidence and of the causes, for people."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

KIND = {
    "actuator": "It comes from the actuator.",
    "tuning": "It comes from the tuning: controller and process together are hardly damped at this period.",
    "disturbance": "It comes from outside: the loop itself is damped at this period.",
    "set point": "It is commanded: SP moves so, and PV follows.",
    "sensor": "It comes from the measurement: PV moves in coarse steps.",
    "unknown": "Where it comes from is not known.",
    "none": "",
}
LABEL = MappingProxyType(  # of each feature: short name, meaning of the value
    {
        "memory": ("sticking predicts", "log(1 + gain / 3), in likelihood over a linear process"),
        "shape": ("wave shape", "above 0 triangle, below sine (He)"),
        "waveform": ("trend looks stuck", "log-odds by networks that saw simulated loops"),
        "dead_zone": ("dead zone predicts", "log(1 + gain), in likelihood over a healthy valve"),
        "saturation": ("limit predicts", "log(1 + gain), in likelihood over a healthy valve"),
        "sine": ("swings as a sine", "below 0: moved from outside, or badly tuned"),
    }
)
OF_THE_WAVE = ("shape", "waveform", "sine")
NOT_COUNTED = "not counted: SP swings so, and PV has its form"
CAUSE = MappingProxyType({"none": "no actuator fault", "actuator": "a fault of the actuator"})


def probability(value: float) -> str:
    """Probability in whole percent that is never certain.

    Examples
    --------
    >>> probability(0.936), probability(0.9998), probability(0.001)
    ('94 %', 'over 99 %', 'under 1 %')
    """
    if value > 0.99:
        return "over 99 %"
    return "under 1 %" if value < 0.01 else f"{100.0 * value:.0f} %"


def cause(name: str) -> str:
    """Class of the verdict in words.

    Examples
    --------
    >>> cause("actuator"), cause("dead zone")
    ('a fault of the actuator', 'dead zone')
    """
    return CAUSE.get(name, name)


@dataclass(frozen=True)
class Balance:
    """Log-odds of the most probable fault against no actuator fault.

    Attributes
    ----------
    fault : str
        Class of the verdict, in words.
    before : float
        Without any of this evidence.
    total : float
        With all of it.
    """

    fault: str
    before: float
    total: float


def balance(probabilities: Mapping[str, float], weights: Iterable[float]) -> Balance:
    """What the weights of the evidence add up to.

    Examples
    --------
    >>> found = balance({"none": 0.1, "actuator": 0.9}, [3.0, -0.5])
    >>> found.fault, round(found.before, 2), round(found.total, 2)
    ('a fault of the actuator', -0.3, 2.2)
    """
    fault = max((name for name in probabilities if name != "none"), key=probabilities.__getitem__)
    total = math.log(max(probabilities[fault], 1e-300) / max(probabilities["none"], 1e-300))
    return Balance(cause(fault), total - sum(weights), total)
