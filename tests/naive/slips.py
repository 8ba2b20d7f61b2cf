"""Slips of a sticking valve in plain Python: patterns from the positions alone."""

from __future__ import annotations

import numpy as np

from tests.naive import stiction


def position(model, u, band, jump, start):
    """Of Kano's or He's valve."""
    return {1: stiction.kano, 2: stiction.he}[model](u, band, jump, start)


def table(y, outputs, x, delay, inputs, start, stop):
    """Products of 1, past y, x and y with lagged x, row by row."""
    rows = range(start, stop)
    right = np.array([[x[k - delay - j] for j in range(inputs)] for k in rows])
    left = np.array(
        [[1.0, *(y[k - 1 - i] for i in range(outputs)), *(x[k - delay - i] for i in range(inputs)), y[k]] for k in rows]
    )
    return left.T @ right


def filtered(x, numerator, a):
    """numerator/A x from rest."""
    out = []
    for k in range(len(x)):
        value = sum(c * x[k - i] for i, c in enumerate(numerator) if k >= i)
        value -= sum(c * out[k - 1 - i] for i, c in enumerate(a) if k > i)
        out.append(value)
    return np.array(out)
