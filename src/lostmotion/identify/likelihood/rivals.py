"""Other places of an actuator that fit about as well as the best."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray

RIVAL = 20.0  # BIC of rough fits: less than this apart is told to the reader
APART = 0.3  # deviations of OP between the break points of two rivals


def rivals(seen: list[tuple[FloatArray, float]]) -> tuple[tuple[FloatArray, float], ...]:
    """Actuators other than the best that came within RIVAL of it, best first, one for each place.

    Parameters
    ----------
    seen : list of (ndarray, float)
        Actuator parameters and information criterion of every rough fit.
    """
    if not seen or not seen[0][0].size:
        return ()
    (first, best), *others = sorted(seen, key=lambda item: item[1])
    kept, found = [first], []
    for eta, score in others:
        if score - best > RIVAL:
            break
        if all(np.abs(eta[:2] - other[:2]).max() > APART for other in kept):
            kept.append(eta)
            found.append((eta, score - best))
    return tuple(found)
