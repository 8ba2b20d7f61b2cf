"""Weights of evidence for a fault of the actuator, calibrated by ``benchmarks/diagnosis.py`` on simulated loops only.

Logistic regression with a ridge: log-odds = constant + sum of weight times feature.
"""

from __future__ import annotations

from dataclasses import fields

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
CONSTANT = -1.02
WEIGHTS = (1.54, 1.07, 0.89, -4.87, 12.46, -1.51, 8.83)
