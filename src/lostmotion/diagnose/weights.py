"""Weights of evidence for a fault of the actuator: simulated loops say them, labelled real loops what they are worth.

Made by ``benchmarks/diagnosis.py --calibrate --cases 400`` (how: benchmarks/verdicts/calibrate.py). Two faults are
weighed against none: a valve that sticks, and a dead zone or saturation; log-odds = constant + sum of weight times
feature, over the features of each.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
OF_STICKING = np.array([name in ("memory", "shape", "waveform") for name in NAMES])  # the rest: of the other faults
CONSTANTS = (-1.75, -1.67)  # log-odds of the two where all features are 0
WEIGHTS = (1.03, 2.86, 0.45, 1.90, 1.96, 58.75)  # in the order of NAMES
SIMULATED = (-1.75, -1.67, 1.82, 5.05, 0.80, 1.90, 1.96, 58.75)  # constants and weights by simulated loops alone
