"""Play operator, its inverse, and its derivatives by the complex step."""

import numpy as np

STEP = 1e-30


def backlash(u, width, start):
    """Positions for all u: pushed when the gap is used up, at rest otherwise; NaN in u is a lost sample."""
    x, positions = start, []
    for command in u:
        if np.isnan(command):
            positions.append(np.nan)
            continue
        if x is None:
            x = command
        gap = np.real(command - x)
        if gap > np.real(width) / 2:
            x = command - width / 2
        elif gap < -np.real(width) / 2:
            x = command + width / 2
        positions.append(x)
    return np.array(positions)


def inverse(v, width, side=0):
    """Commands for all wanted positions: half the width ahead in the direction of the last move."""
    commands = []
    for k, wanted in enumerate(v):
        moves = [side, *np.sign(np.diff(v[: k + 1]))]
        latest = [move for move in moves if move != 0]
        commands.append(wanted + (latest[-1] if latest else 0) * width / 2)
    return np.array(commands)


def derivatives(u, width, start):
    """dx by width and by start, shape (2, n), by the complex step."""
    by_width = backlash(u, width + 1j * STEP, complex(start)).imag / STEP
    by_start = backlash(u, complex(width), start + 1j * STEP).imag / STEP
    return np.array([by_width, by_start])
