"""A loop of an ingredient: drawn, simulated, recorded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import lostmotion as lm
from one_ingredient.changes import CHANGES
from one_ingredient.controller_and_process import Controller, Process, Signals, closed_loop
from one_ingredient.draw import Case, base_case, met, streams_of, valve_of
from one_ingredient.record import Recording
from one_ingredient.signals import fine_times
from one_ingredient.tuning import Tuning, tuned
from one_ingredient.valves import FINE_STEP, FINE_STEPS


@dataclass(frozen=True)
class Loop:
    """What is recorded, and the truth."""

    ingredient: str
    seed: int
    case: Case
    recording: Recording
    met: int  # how often OP goes through the whole fault

    @property
    def record(self) -> lm.LoopRecord:
        """For the package."""
        return self.recording.record(self.case.seconds)


def loop_of(ingredient: str, seed: int) -> Loop:
    """The loop with this seed."""
    change, streams = CHANGES[ingredient], streams_of(seed)
    case = base_case(streams.case, seed)
    change.case(case, streams.change)
    tuning = tuned(case)
    set_point = change.set_point(case, streams) + 50.0
    times = fine_times(case)
    load = np.interp(times, np.arange(case.rows + 1), change.slow_load(case, streams))
    load = load + change.wave(case, times, tuning.ultimate_period, streams) - (case.rest - 50.0)
    measurements = times.size // min(case.scan, FINE_STEPS) + 2
    noise = streams.noise.normal(size=measurements) * case.noise
    manual, manual_output = change.hand(case, streams)
    controller, process = _controller(case, tuning), _process(case, tuning)
    signals = Signals(set_point, manual, manual_output, load, noise)
    op, pv, mean_op, mean_pv = closed_loop(signals, controller, valve_of(case), process, case.transmitter_lag)
    recording = Recording(op.copy(), pv, set_point, mean_op, mean_pv, manual)
    change.record(recording, case, streams.change)
    return Loop(ingredient, seed, case, recording, met(case, op))


def _controller(case: Case, tuning: Tuning) -> Controller:
    return Controller(
        gain=case.sign * tuning.gain,
        reset=tuning.reset,
        derivative=tuning.derivative,
        filter_lag=tuning.derivative_filter,
        gap=case.gap,
        feedforward=case.feedforward,
        velocity_form=case.velocity_form,
        scan=case.scan,
        rest=case.rest,
    )


def _process(case: Case, tuning: Tuning) -> Process:
    return Process(
        kind=case.process,
        gain=case.sign * tuning.process_gain,
        lag=case.lag,
        second_lag=case.second_lag,
        damping=case.damping,
        lead=case.lead,
        dead_steps=round(case.dead_time / FINE_STEP),
        curvature=case.curvature,
    )
