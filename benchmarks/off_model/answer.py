"""What ``identify`` answers, as numbers that go into a file, within a bound on time."""

from __future__ import annotations

import signal
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import lostmotion as lm

LIMIT = 120.0  # s for a record
CANNOT_TELL, NONE = "cannot tell", "none"
NO_ANSWER, REFUSED, CRASHED = "no answer", "refused", "crashed"
Interval = tuple[float, float]
UNKNOWN = (float("nan"), float("nan"))


class OutOfTime(BaseException):
    """The bound on time is reached; no ``except Exception`` inside stops it."""


@dataclass(frozen=True)
class Answer:
    """Of one record.

    Attributes
    ----------
    kind : str
        ``fit.preferred``, `NO_ANSWER` where time ran out, `REFUSED` where the package raised an error of its own,
        `CRASHED` where it raised another.
    fitted : str
        ``fit.nonlinearity.kind``.
    size, interval : float, (float, float)
        Of the lost motion where the fit shows one (``fit.shown_size``), with ``fit.size_interval``.
    ends : dict
        Interval of each parameter of the actuator.
    excluded : dict
        Size of each kind above which it is excluded.
    """

    kind: str
    status: str = ""
    fitted: str = ""
    confidence: float = float("nan")
    size: float = float("nan")
    interval: Interval = UNKNOWN
    values: dict[str, float] = field(default_factory=dict)
    ends: dict[str, Interval] = field(default_factory=dict)
    excluded: dict[str, float] = field(default_factory=dict)
    seconds: float = float("nan")
    reason: str = ""

    @property
    def ok(self) -> bool:
        """Status OK."""
        return self.status == "OK"

    @property
    def named(self) -> bool:
        """Whether a kind is named, or that there is none."""
        return self.kind not in (CANNOT_TELL, NO_ANSWER, REFUSED, CRASHED)

    @property
    def sized(self) -> bool:
        """Whether there is a size with an interval."""
        return bool(np.isfinite([self.size, *self.interval]).all())

    def holds(self, size: float) -> bool:
        """Whether the interval of the size holds this."""
        return self.interval[0] <= size <= self.interval[1]

    def __str__(self) -> str:
        size = f" {self.size:.3g} ({self.interval[0]:.3g} to {self.interval[1]:.3g})" if self.sized else ""
        return f"{self.kind}{size}, {self.status or self.reason}, {self.seconds:.1f} s"


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise `OutOfTime` in the main thread of a process when so much time is over."""

    def stop(*_: Any) -> None:
        raise OutOfTime

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def identified(op: np.ndarray, pv: np.ndarray, dt: float, limit: float = LIMIT) -> tuple[Answer, Any]:
    """Answer to a record, and the fit itself where there is one."""
    begun = time.perf_counter()
    try:
        with warnings.catch_warnings(), time_limit(limit):
            warnings.simplefilter("ignore")
            fit = lm.identify(op, pv, dt)
            return answer_of(fit, time.perf_counter() - begun), fit
    except OutOfTime:
        return Answer(NO_ANSWER, seconds=time.perf_counter() - begun, reason=f"no answer in {limit:g} s"), None
    except lm.InputError as refused:
        return Answer(REFUSED, seconds=time.perf_counter() - begun, reason=str(refused)), None
    except Exception as crash:  # noqa: BLE001 - one record of hundreds; the row shows it
        return Answer(CRASHED, seconds=time.perf_counter() - begun, reason=repr(crash)), None


def answer_of(fit: Any, seconds: float = float("nan")) -> Answer:
    """What a fit says."""
    name = fit.shown_size
    own = [one for one in (*fit.nonlinearity.own, "width") if one in fit.parameters]
    excluded = {} if fit.kinds is None else {kind: float(size) for kind, size in fit.kinds.excluded.items()}
    return Answer(
        kind=fit.preferred,
        status=fit.status.name,
        fitted=fit.nonlinearity.kind,
        confidence=float("nan") if fit.kinds is None else float(fit.kinds.confidence),
        size=float("nan") if name is None else float(fit.parameters[name]),
        interval=UNKNOWN if name is None else _floats(fit.size_interval),
        values={one: float(fit.parameters[one]) for one in own},
        ends={one: _floats(fit.interval(one)) for one in own},
        excluded=excluded,
        seconds=seconds,
    )


def _floats(ends: Any) -> Interval:
    return float(ends[0]), float(ends[1])
