"""Log-odds of the verdicts, calibrated by ``benchmarks/diagnosis.py`` on simulated loops only.

Multinomial logistic regression with a ridge: row = class, first column = constant, then the features in order.
"""

from __future__ import annotations

from dataclasses import fields
from types import MappingProxyType

import numpy as np

from lostmotion.diagnose.features import Features

CLASSES = ("none", "dead zone", "sticking", "saturation")
NAMES = tuple(field.name for field in fields(Features))
MEANING = MappingProxyType(
    {
        "dead_zone": "log(1 + gain) of a dead zone over a linear process, in log predictive density",
        "memory": "the same for stiction or backlash",
        "saturation": "the same for a saturation",
        "oscillating": "OP or PV swings regularly (1) or not (0)",
        "shape": "triangle (above 0) or sine (below 0): He's index minus 0.5",
        "odd": "asymmetry of the cross-correlation of OP and PV (Horch)",
        "relay": "square (above 0) or sine (below 0): relay index of PV (Rossi and Scali)",
        "nonlinear": "nonlinearity index of PV (Choudhury)",
        "misfit": "the best actuator does not describe the record (1)",
    }
)
WEIGHTS = np.zeros((len(CLASSES), 1 + len(NAMES)))
