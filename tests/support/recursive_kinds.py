"""Recursive estimators that ``tests/contract/test_recursive_estimators.py`` checks, and the records they take."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import lostmotion as lm

NAN, INF = float("nan"), float("inf")
ORDERS = (1, 1, 1)
PLANT = lm.Hammerstein(lm.DeadZone(-1, 1, 2, 3), lm.LinearModel((-0.6,), (0.4, 0.2), 1))
READY = 300  # samples after which every kind has started
LENGTH = 600


@dataclass(frozen=True)
class Kind:
    """An estimator with options; `missing`: samples may be NaN or masked, `bad`: settings of its own to be refused."""

    name: str
    build: Callable[..., Any]
    options: dict[str, Any]
    missing: bool = False
    bad: list[tuple[dict[str, Any], str]] = field(default_factory=list)

    def fresh(self, **options):
        return self.build(*ORDERS, **{**self.options, **options})

    def record(self, seed=0):
        """Columns for `run`: command, measurement and, where that is known, which samples to use."""
        return plain_record(self.missing, seed)

    def started(self):
        """One that has taken READY samples; a start costs time."""
        return self.build.from_bytes(bytes_of_started(self.name))


def feed(estimator, record, first, stop, every=1):
    """Let it take some rows of a record."""
    u, y, *use = (column[first:stop] for column in record)
    return estimator.run(u, y, every, **({"use": use[0]} if use else {}))


@functools.cache
def plain_record(missing, seed):
    u = lm.signals.prs(LENGTH, -5, 5, hold=10, seed=seed)
    rng = np.random.default_rng(seed)
    y = PLANT.simulate(u) + 0.1 * rng.normal(size=LENGTH)
    if not missing:
        return u, y
    late, use = np.arange(LENGTH) > LENGTH // 3, np.ones(LENGTH, dtype=bool)
    y[late & (rng.random(LENGTH) < 0.02)] = NAN
    u[late & (rng.random(LENGTH) < 0.02)] = NAN
    y[late & (rng.random(LENGTH) < 0.01)] += 3.0
    use[350:367] = False
    return u, y, use


@functools.cache
def bytes_of_started(name):
    kind = next(kind for kind in KINDS if kind.name == name)
    estimator = kind.fresh(dt=0.1)
    feed(estimator, kind.record(), 0, READY)
    assert estimator.started
    return estimator.to_bytes()


IV_BAD = [
    ({"forgetting": 0.0}, "forgetting"),
    ({"forgetting": -0.5}, "forgetting"),
    ({"method": "iv"}, "riv"),
    ({"method": "RIV"}, "riv"),
    ({"form": "paper"}, "printed"),
    ({"start_samples": -1}, "start_samples"),
    ({"constant_for": 2.5}, "constant_for"),
]
ML_BAD = [
    ({"forgetting": 0.95}, "forgetting"),
    ({"noise": "pink"}, "noise"),
    ({"noise": -1}, "noise"),
    ({"noise": 1.5}, "noise"),
    ({"offset": "none"}, "offset"),
    ({"offset": None}, "offset"),
    ({"offset": np.array(["auto", "free"])}, "offset"),
    ({"start_samples": 50}, "start_samples"),
    ({"outliers": 1.0}, "outliers"),
    ({"outliers": INF}, "outliers"),
    ({"outliers": "few"}, "outliers"),
    ({"false_alarms": 0.0}, "false_alarms"),
    ({"false_alarms": 0.5}, "false_alarms"),
    ({"false_alarms": NAN}, "false_alarms"),
]
ANY_BAD = [
    *(({name: value}, name) for name in ("na", "nb", "delay") for value in (-1, 1.5, "two", None, NAN)),
    *(({"gain": value}, "gain") for value in (0, 0.0, NAN, INF, "high")),
    *(({"forgetting": value}, "forgetting") for value in (1.0001, NAN)),
    *(({"dt": value}, "dt") for value in (0.0, -1.0)),
    ({"start_samples": 100.5}, "start_samples"),
]
GAIN = PLANT.linear.gain


def iv_kind(method, form):
    options = {"gain": GAIN, "method": method, "form": form, "start_samples": 120, "constant_for": 400}
    return Kind(f"RecursiveIV {method} {form}", lm.RecursiveIV, options, bad=IV_BAD)


def ml_kind(name, **options):
    return Kind(f"RecursiveML {name}", lm.RecursiveML, {"start_samples": 120, **options}, missing=True, bad=ML_BAD)


KINDS = [
    *(iv_kind(method, "convergent") for method in ("riv", "rls", "els")),
    *(iv_kind(method, "printed") for method in ("riv", "rls")),
    ml_kind("white", noise="white", gain=GAIN),
    ml_kind("that forgets", noise=2, forgetting=0.99),
]
