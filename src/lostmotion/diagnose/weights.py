"""Weights of evidence for a fault of the actuator, calibrated on simulated loops only.

Made by ``benchmarks/diagnosis.py --calibrate --cases 400``. Logistic regression with a ridge: log-odds = constant + sum
of weight times feature. Tried and left out: Horch's correlation and Rossi and Scali's relay index, which on simulated
loops say nothing that shape does not; log(1 + gain), the root and the cube root of the gain, which fit no better.
"""

from __future__ import annotations

from dataclasses import fields

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
CONSTANT = -1.04  # log-odds where all features are 0
WEIGHTS = (1.29, 1.85, 1.33, -2.01, 7.93)  # in the order of NAMES
