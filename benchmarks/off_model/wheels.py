"""Four real motors with a dead zone, thinned: kind and width, and held-out simulation beside a plain fit.

No motion for duties of up to 8.8 to 9 %, then straight lines that reach zero at +6.0 to 6.35 and -5.7 to -6.2: full
width 12.0 to 12.5 (../shared/actuators/README.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import lfilter

from .answer import Answer, identified
from .bars import MET, MISSED, at_least, at_most, summary, table
from .places import ACTUATORS
from .suites import Job, Suite

FOLDER = "wheels"
STEP = 0.002  # s between rows of the files
THINNED = (1, 10, 50, 100)  # 2, 20, 100, 200 ms
WHEELS = (1, 2, 3, 4)
WIDTH = (10.0, 13.5)  # % of duty
KIND = "dead zone"
LAG = 0.035  # s: the longest time constant that is seen
BURN_IN = 10.0 * LAG
MARGIN = 0.3  # % of fit


@dataclass(frozen=True)
class WheelRow:
    """Answer to one wheel at one rate."""

    wheel: int
    milliseconds: float
    answer: Answer

    @property
    def right(self) -> bool:
        """Kind and width."""
        return self.answer.kind == KIND and WIDTH[0] <= self.answer.size <= WIDTH[1]

    @property
    def wrong(self) -> bool:
        """Named otherwise, or of another width, with a status that says it can be used."""
        return self.answer.ok and self.answer.named and not self.right

    def __str__(self) -> str:
        return f"wheel {self.wheel} at {self.milliseconds:g} ms: {self.answer}"


@dataclass(frozen=True)
class HeldOutRow:
    """Fit in % of the second half, simulated from its input alone, by a model of the first half."""

    wheel: int
    milliseconds: float
    answer: Answer
    ours: float
    plain: float
    plain_zone: tuple[float, float]

    def __str__(self) -> str:
        at = f"wheel {self.wheel} at {self.milliseconds:g} ms"
        return f"{at}: {self.ours:.2f} % beside {self.plain:.2f} %; {self.answer}"


def read(wheel: int, every: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Duty, speed, sampling time."""
    rows = np.loadtxt(ACTUATORS / FOLDER / f"wheel{wheel}.csv", delimiter=",", skiprows=1)[::every]
    return rows[:, 1], rows[:, 2], STEP * every


def wheel_jobs(_: Sequence[int]) -> list[list[Job]]:
    return [[Job("wheels", wheel, rate=every)] for wheel in WHEELS for every in THINNED]


def held_out_jobs(_: Sequence[int]) -> list[list[Job]]:
    return [[Job("held_out", wheel, rate=every)] for wheel in WHEELS for every in THINNED]


def wheel_row(job: Job) -> WheelRow:
    return WheelRow(job.cell, 1e3 * STEP * job.rate, identified(*read(job.cell, job.rate))[0])


def held_out_row(job: Job) -> HeldOutRow:
    u, y, dt = read(job.cell, job.rate)
    half = u.size // 2
    answer, fit = identified(u[:half], y[:half], dt)
    plain = PlainFit.of(u[:half], y[:half], dt)
    ours = (
        float("nan") if fit is None else held_out_fit(u[half:], y[half:], dt, fit.model.simulate(u[half:]), poles(fit))
    )
    simulated = held_out_fit(u[half:], y[half:], dt, plain.simulate(u[half:]), np.array([1.0, -plain.pole]))
    return HeldOutRow(job.cell, 1e3 * STEP * job.rate, answer, ours, simulated, (plain.left, plain.right))


def poles(fit: Any) -> np.ndarray:
    """A of the process, with its leading 1; no more than 1 where the model has no linear part of that form."""
    return np.array([1.0, *getattr(getattr(fit.model, "linear", None), "a", ())])


def held_out_fit(u: np.ndarray, y: np.ndarray, dt: float, simulated: np.ndarray, a: np.ndarray) -> float:
    """Fit in % behind the burn-in, from the initial state (free response of A) and offset that suit PV best."""
    impulse = np.zeros(u.size)
    impulse[0] = 1.0
    response = lfilter([1.0], a, impulse)
    shifted = [np.concatenate([np.zeros(lag), response[: u.size - lag]]) for lag in range(a.size - 1)]
    columns = np.column_stack([np.ones(u.size), *shifted])
    best = columns @ np.linalg.lstsq(columns, y - simulated, rcond=None)[0] + simulated
    after = slice(int(np.ceil(BURN_IN / dt)), None)
    return 100.0 * (1.0 - np.linalg.norm(y[after] - best[after]) / np.linalg.norm(y[after] - y[after].mean()))


@dataclass(frozen=True)
class PlainFit:
    """Dead zone and a first-order process by output error, with SciPy alone: what anybody would try first."""

    left: float
    right: float
    gain: float
    pole: float

    @classmethod
    def of(cls, u: np.ndarray, y: np.ndarray, dt: float) -> PlainFit:
        """From a naive start: a tenth of the range of OP on either side, gain of the ranges, 50 ms or a row."""
        gain = np.ptp(y) / np.ptp(u)
        start = np.array([-0.1 * np.ptp(u), 0.1 * np.ptp(u), gain, np.exp(-dt / max(0.05, dt))])
        low, high = [-np.inf, -np.inf, -np.inf, 0.0], [np.inf, np.inf, np.inf, 0.9999]
        scale = [0.1 * np.ptp(u), 0.1 * np.ptp(u), gain, 0.1]

        def errors(theta: np.ndarray) -> np.ndarray:
            return cls(*theta).simulate(u, y[0]) - y

        return cls(*least_squares(errors, start, bounds=(low, high), x_scale=scale).x.tolist())

    def simulate(self, u: np.ndarray, first: float = 0.0) -> np.ndarray:
        """PV from OP alone, which acts on the next row; `first` is PV on the first row."""
        x = np.maximum(u - self.right, 0.0) + np.minimum(u - self.left, 0.0)
        aim = self.gain * x
        driven = lfilter([0.0, 1.0 - self.pole], [1.0, -self.pole], aim)
        return driven + first * self.pole ** np.arange(u.size)


def wheel_report(rows: list[WheelRow]) -> list[str]:
    lines = table(
        ("wheel", "ms", "kind", "status", "size", "interval", "s"),
        [(one.wheel, f"{one.milliseconds:g}", *cells(one.answer), f"{one.answer.seconds:.1f}") for one in rows],
    )
    dead = [one for one in rows if one.answer.kind == KIND]
    # 15 of the 16 wheels and rates
    return lines + summary([
        at_least("kind dead zone", [one.answer.kind == KIND for one in rows], 15 / 16),
        at_least(f"width {WIDTH[0]:g} to {WIDTH[1]:g}, of dead zones", [one.right for one in dead], 1.0),
        at_least("intervals of a wheel overlap, pairs of rates", overlaps(dead), 1.0),
        at_most("wrong with status OK", [one.wrong for one in rows], 0.0),
    ])  # fmt: skip


def overlaps(rows: list[WheelRow]) -> list[bool]:
    """Whether the intervals of one wheel at two rates have something in common."""
    pairs = [pair for pair in combinations(rows, 2) if pair[0].wheel == pair[1].wheel]
    both = [(one.answer.interval, other.answer.interval) for one, other in pairs]
    return [max(one[0], other[0]) <= min(one[1], other[1]) for one, other in both]


def cells(answer: Answer) -> tuple[str, str, str, str]:
    """Kind, status, size, interval."""
    if not answer.sized:
        return answer.kind, answer.status or answer.reason, "-", "-"
    return answer.kind, answer.status, f"{answer.size:.3g}", f"{answer.interval[0]:.3g} to {answer.interval[1]:.3g}"


def held_out_report(rows: list[HeldOutRow]) -> list[str]:
    lines = table(
        ("wheel", "ms", "kind", "status", "size", "interval", "fit, %", "plain fit, %", "plain zone"),
        [
            (one.wheel, f"{one.milliseconds:g}", *cells(one.answer), f"{one.ours:.2f}", f"{one.plain:.2f}",
             f"{one.plain_zone[0]:.2f} to {one.plain_zone[1]:.2f}")
            for one in rows
        ],
    )  # fmt: skip
    judged = []
    for rate in dict.fromkeys(one.milliseconds for one in rows):
        mine = [one for one in rows if one.milliseconds == rate]
        ours, plain = (float(np.mean([getattr(one, name) for one in mine])) for name in ("ours", "plain"))
        bar = plain - MARGIN
        judged.append([f"mean fit at {rate:g} ms", f"{ours:.2f} %", f">= {bar:.2f} %", MET if ours >= bar else MISSED])
    return lines + summary(judged)


SUITES = (
    Suite("wheels", wheel_jobs, wheel_row, wheel_report, FOLDER),
    Suite("held_out", held_out_jobs, held_out_row, held_out_report, FOLDER),
)
