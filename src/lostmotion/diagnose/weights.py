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
CONSTANTS = (-1.84, -1.71)  # log-odds of the two where all features are 0
WEIGHTS = (1.02, 2.95, 0.43, 1.77, 1.48, 48.30)  # in the order of NAMES
SIMULATED = (-1.84, -1.71, 1.82, 5.27, 0.77, 1.77, 1.48, 48.30)  # constants and weights by simulated loops alone
