"""Our own estimators on the records of the experiment."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import lostmotion as lm
from suite.experiment import DT, GAIN, NAMES, ORDERS, Answers, Array, fresh

HAS_ML = hasattr(lm, "RecursiveML")


def recursive_iv() -> Any:
    return lm.RecursiveIV(*ORDERS, GAIN, dt=DT)


def recursive_ml(forgetting: float = 1.0, **options: Any) -> Any:
    return lm.RecursiveML(*ORDERS, GAIN, forgetting, dt=DT, **options)


ONLINE: dict[str, Callable[[], Any]] = {"RecursiveIV": recursive_iv}
if HAS_ML:
    ONLINE["RecursiveML"] = recursive_ml
TRACKING = {"RecursiveML, forgetting 0.999": lambda: recursive_ml(0.999)} if HAS_ML else {}


def online(make: Callable[[], Any]) -> Callable[[Array, Array], Any]:
    """Estimate of a whole record by ``run``."""

    def work(u: Array, y: Array) -> Any:
        estimator = make()
        estimator.run(u, y, every=u.size)
        return estimator.estimate

    return work


def batch(u: Array, y: Array) -> Any:
    return lm.identify(u, y, DT, orders=ORDERS, gain=GAIN, nonlinearity="dead zone")


def answers(work: Callable[[Array, Array], Any], records: list[tuple[Array, Array]]) -> Answers:
    """Run `work` on every record, one after the other, after a warm-up that compiles."""
    command = fresh()[0]
    work(*records[0])
    zone, simulated, seconds = [], [], []
    for u, y in records:
        begin = time.process_time()
        estimate = work(u, y)
        seconds.append(time.process_time() - begin)
        zone.append([estimate.parameters[name] for name in NAMES])
        simulated.append(estimate.model.simulate(command))
    return Answers(np.array(zone), np.array(simulated), np.array(seconds))
