"""Weights of evidence for a fault of the actuator: simulated loops as the prior, labelled real loops as the data.

Made by ``benchmarks/diagnosis.py --calibrate --cases 400`` (how: benchmarks/verdicts/calibrate.py). Log-odds =
constant + sum of weight times feature.
"""

from __future__ import annotations

from dataclasses import fields

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
CONSTANT = -1.91  # log-odds where all features are 0
WEIGHTS = (0.97, 1.46, 1.29, 8.33)  # in the order of NAMES
SIMULATED = (-1.75, 0.97, 1.97, 1.29, 8.96)  # constant and weights by simulated loops alone
