"""A lag that is faster in one direction, in fine steps, and what it lacks."""

import math


def simulated(x, pole, up, outward, centre, steps):
    """The lag alone, (n,): its value before each row, from rest at the first."""
    z, found = x[0], []
    for value in x:
        found.append(z)
        for _ in range(steps):
            d = value - z
            side = math.copysign(1.0, z - centre) if z != centre else 0.0
            z += (1.0 - pole ** (1.0 / steps)) * (d + up * abs(d) + outward * abs(d) * side)
    return found


def linear(x, inputs, pole):
    """A linear lag driven by x and these inputs, (n,): its value before each row."""
    z, found = x[0], []
    for value, more in zip(x, inputs, strict=True):
        found.append(z)
        z += (1.0 - pole) * (value + more - z)
    return found
