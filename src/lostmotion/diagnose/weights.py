"""Weights of evidence for a fault of the actuator: simulated loops as the prior, labelled real loops as the data.

Made by ``benchmarks/diagnosis.py --calibrate --cases 400`` (how: benchmarks/verdicts/calibrate.py). Log-odds =
constant + sum of weight times feature.
"""

from __future__ import annotations

from dataclasses import fields

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
CONSTANT = -1.92  # log-odds where all features are 0
WEIGHTS = (1.37, 1.4, 1.12, 5.6, 1.6, 0.1)  # in the order of NAMES
SIMULATED = (-0.34, 1.37, 1.95, 1.12, 3.0, 0.06, -0.71)  # constant and weights by simulated loops alone
