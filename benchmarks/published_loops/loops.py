"""The loops, by name."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from scipy.signal import lfilter

import lostmotion as lm
from published_loops.case import Case
from published_loops.closed_loop import BEFORE, Driven, Recorded, closed_loop
from published_loops.faulty import faulty_cases
from published_loops.signals import Array, Rng, Setting, Signal
from published_loops.sound import sound_cases
from published_loops.truth import Truth, truth_of

LEAST_SWING = 0.02  # % of PV, of an integrating process
SHARE_OF_SIZE = 0.3  # of the size of the fault times the gain: a swing that noise is told in, at least
MOST, WIDEST = 90, 2.0  # percentile of the error that is half a swing, and how far it may be from that at rest


@dataclass(frozen=True)
class PublishedLoop:
    """What is recorded, and the truth."""

    case: Case
    recorded: Recorded
    truth: Truth

    @property
    def record(self) -> lm.LoopRecord:
        """For the package."""
        one = self.recorded
        return lm.LoopRecord(one.op, one.pv, one.sp, dt=self.case.plant.seconds, op_span=(0, 100))


@cache
def cases() -> dict[str, Case]:
    """All loops by name, in the order of the tables."""
    return {case.name: case for case in (*faulty_cases(), *sound_cases())}


def loops() -> Iterator[PublishedLoop]:
    """All loops, simulated one by one."""
    yield from map(published_loop, cases())


def published_loop(name: str, seed: int = 0) -> PublishedLoop:
    """The loop of this name; the same again for the same seed, whatever other loops there are."""
    case = cases()[name]
    loads, noises, swings = np.random.default_rng([zlib.crc32(name.encode()), seed]).spawn(3)
    recorded = closed_loop(case.plant, case.valve, _driven(case, loads, noises, swings))
    return PublishedLoop(case, recorded, truth_of(case.valve, recorded))


def _driven(case: Case, loads: Rng, noises: Rng, on_pv: Rng) -> Driven:
    """Set point, load and noise; the noise is told in the swing that the loop has without it."""
    still, silent = np.zeros(case.rows), np.zeros(BEFORE + case.rows)
    gain = case.plant.process.gain
    swing = np.nan
    if case.valve.size > 0:
        swing = float(np.ptp(closed_loop(case.plant, case.valve, Driven(still, still, silent)).pv))
    setting = Setting(case.rows, case.plant.seconds, loads, case.valve.size, gain, swing)
    set_point, load = _signal(case.course.set_point, setting), _signal(case.course.load, setting)
    deviation = case.course.noise
    if deviation == 0:
        deviation = case.course.share * _swing(case, swing, Driven(set_point, load, silent))
    noise = deviation * _noise(noises, case.course.colour, silent.size)
    noise[BEFORE:] += _signal(case.course.on_pv, setting._replace(rng=on_pv))
    return Driven(set_point, load, noise, case.course.sensor)


def _signal(signal: Signal | None, setting: Setting) -> Array:
    return np.zeros(setting.rows) if signal is None else signal(setting)


def _noise(rng: Rng, pole: float, rows: int) -> Array:
    """Of deviation 1."""
    return np.asarray(lfilter([np.sqrt(1 - pole * pole)], [1.0, -pole], rng.standard_normal(rows)))


def _swing(case: Case, at_rest: float, driven: Driven) -> float:
    """Swing of PV that a share of noise is meant of."""
    gain = case.plant.process.gain
    swing = max(at_rest, LEAST_SWING if np.isnan(gain) else SHARE_OF_SIZE * case.valve.size * abs(gain))
    if not (np.any(driven.set_point) or case.course.load):
        return swing
    moved = closed_loop(case.plant, case.valve, driven)
    errors = 2 * float(np.percentile(np.abs(moved.pv - moved.sp), MOST))
    return max(min(errors, WIDEST * swing), swing / WIDEST)
