"""What the estimators are compiled to, loaded before values come."""

from __future__ import annotations

import numpy as np

from lostmotion.files.grid import Rows
from lostmotion.identify import RecursiveML
from lostmotion.online.monitor import OnlineMonitor

SAMPLES, CHANGE = 1500, 1000


def warm() -> None:
    """Load what is compiled: it takes seconds, the first time minutes.

    A loop whose dead zone jumps from 0.6 to 1.6 and stays: a first fit, reports, an alarm and its fits, a point of the
    trend. What is not met here is compiled when it is met, while rows wait.
    """
    rng = np.random.default_rng(0)
    u = np.repeat(rng.uniform(-2.0, 2.0, SAMPLES // 5), 5)
    half = np.where(np.arange(SAMPLES) < CHANGE, 0.3, 0.8)
    x = np.sign(u) * np.maximum(np.abs(u) - half, 0.0)
    y = np.convolve(x, 0.5 ** np.arange(20))[:SAMPLES] + 0.01 * rng.standard_normal(SAMPLES)
    monitor = OnlineMonitor(RecursiveML(1, 0, 0, start_samples=200), dt=1.0, report_every=250, trend_every=500)
    monitor.take(Rows(np.arange(SAMPLES, dtype=np.float64), u, y))
