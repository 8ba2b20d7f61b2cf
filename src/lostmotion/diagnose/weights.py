"""Weights of evidence for a fault of the actuator, calibrated on simulated loops only.

Made by ``benchmarks/diagnosis.py --calibrate --cases 400``. Logistic regression with a ridge: log-odds = constant + sum
of weight times feature. Horch's correlation was tried and left out: on simulated loops it says nothing that shape does
not (a slow disturbance is as odd as stiction).
Which processes are allowed in a closed loop (``identify/plausible.py``) has changed a little since.
"""

from __future__ import annotations

from dataclasses import fields

from lostmotion.diagnose.features import Features

NAMES = tuple(field.name for field in fields(Features))
CONSTANT = -0.94
WEIGHTS = (0.67, 1.11, 0.99, -2.15, 8.59, 0.09)
