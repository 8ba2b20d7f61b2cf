"""Stamps of rows -> how many samples each row stands for, row by row, on a clock that follows the stamps."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels.numba_cache import njit

LEAK = 0.9  # share of the phase error that the next row inherits: jitter averages out, a wrong dt does not pile up
BACK = 7200.0  # s: further back is a new recording; less is a repeated stretch, such as the change to winter time
AHEAD = 3.2e7  # s, a year: further ahead is a wrong stamp or a new recording
RESTART = -1  # count of the first row of a new recording
LAST, PHASE, BASE, PASSED_OVER = 0, 1, 2, 3  # places in `state`


@njit()
def count_samples(stamps: FloatArray, dt: float, wrap: float, state: FloatArray, times: FloatArray) -> IntArray:
    """Count the samples that end with each row: 1, more after a gap, 0 for a repeated one, RESTART.

    Parameters
    ----------
    stamps : ndarray, shape (n,)
        Seconds; NaN where a row has none: it then follows the row before by `dt`.
    dt : float
        Sampling time in seconds.
    wrap : float
        Seconds after which the stamps begin anew (times of day); 0 for never.
    state : ndarray, shape (4,)
        Last stamp taken (NaN before the first), phase of the row against the clock in samples, seconds to add to
        the stamps, and 1.0 where a row was passed over since because it came too early. Updated.
    times : ndarray, shape (n,)
        Filled with the time of each row.

    Returns
    -------
    counts : ndarray of int, shape (n,)
    """
    counts = np.empty(stamps.size, dtype=np.int64)
    for k in range(stamps.size):
        last = state[LAST]
        time = stamps[k] + state[BASE]
        if np.isnan(time):
            time = last + dt  # NaN before the first stamp
        elif wrap > 0.0 and time - last < -0.5 * wrap:
            state[BASE] += wrap
            time += wrap
        times[k] = time
        step = time - last
        counts[k] = 1
        if np.isnan(last):
            counts[k] = 0 if np.isnan(time) else 1
        elif step < -BACK or step > AHEAD:
            counts[k] = RESTART
            state[PHASE] = 0.0
        else:
            passed = step / dt + state[PHASE]
            counts[k] = 0 if step <= 0.0 else int(np.floor(passed + 0.5))
            if counts[k] > 0:  # rows that are faster than dt tell the phase exactly
                state[PHASE] = (1.0 if state[PASSED_OVER] > 0.0 else LEAK) * (passed - counts[k])
            elif step > 0.0:
                state[PASSED_OVER] = 1.0
        if counts[k] != 0:
            state[LAST] = time
            state[PASSED_OVER] = 0.0
    return counts
