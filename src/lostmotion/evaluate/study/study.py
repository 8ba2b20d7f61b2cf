"""compensation_study(): one call from a fit to what its compensation would do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, finite_signal, positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.compensate import CompensatorBlock, block_from_fit, block_from_model
from lostmotion.compensate.gate import Said
from lostmotion.errors import ParameterError
from lostmotion.evaluate.study.cycles import (
    cycle_test,
    predicted_cycle,
    simulated_cycle,
)
from lostmotion.evaluate.study.mistakes import mistakes
from lostmotion.evaluate.study.recorded_controller import controller_of, longest_set_point
from lostmotion.evaluate.study.reproduced import require_reproduction
from lostmotion.evaluate.study.scenario import Scenario, started_in_cycle, steps
from lostmotion.evaluate.study.studied_loop import Known, known
from lostmotion.evaluate.study.study_plant import noise_samples
from lostmotion.evaluate.study.study_result import CompensationStudy
from lostmotion.evaluate.study.trial import settling_rows, trial
from lostmotion.identify import RatedEstimate, RecursiveEstimate
from lostmotion.kernels.threads import one_thread
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.records import LoopRecord, RecordLike, as_record
from lostmotion.records.span import PERCENT
from lostmotion.records.white_noise import noise_of
from lostmotion.simulate import PI

SAMPLES = 4000  # of a scenario made up here, where no record is given
MOST_SAMPLES = 20_000  # of a record's set point
BAND_IN_DEVIATIONS = 3.0  # of the noise in OP: one sample in 370 of Gaussian noise is outside
Model = Hammerstein | RatedEstimate | RecursiveEstimate | Mapping[str, Any]


@one_thread
def compensation_study(
    model: Model,
    controller: PI | None = None,
    *,
    record: RecordLike | None = None,
    noise: NoiseModel | float | None = None,
    block: CompensatorBlock | None = None,
    reference: npt.ArrayLike | None = None,
    sp_step: float | None = None,
    hold: float | None = None,
    op_now: float | None = None,
    span: tuple[float, float] | None = None,
    samples: int = SAMPLES,
    runs: int = 10,
    draws: int = 20,
    cycle_samples: int = 6000,
    seed: int = 0,
    diagnosis: Said | None = None,
    accept: str | None = None,
    **options: Any,
) -> CompensationStudy:
    """Simulate the identified loop without, with, and with mis-estimated compensation, and say what is worth it.

    Parameters
    ----------
    model : HammersteinFit, FitFacts, mapping, RecursiveEstimate or Hammerstein
        A fit, from memory or from ``read_fit()``, its ``to_dict()``, an estimate in service of status OK, which needs
        `block`, or a model beside its noise.
    controller : PI, optional
        Gains of the plant's controller; its limits are replaced by the span. None: estimated from `record`, where a
        PI explains the moves of OP.
    record : LoopRecord, path, data frame or dict of columns, optional
        Gives set point and controller where they are not given.
    noise : NoiseModel or float, optional
        Of PV, beside a bare model: model or variance of white noise.
    block : CompensatorBlock, optional
        What is to be downloaded. None: what ``fit.block()`` makes; `options` are passed on to it. Without a
        `factor`, a block that helps but is not safe gives way to one that compensates a smaller share, where that is
        safe.
    reference : array_like, shape (n,), optional
        Set point in units of PV. None: that of the record; without one constant, at the level that needs `op_now`.
    sp_step : float, optional
        Instead of a constant set point: steps of this size up and down, each held for `hold` seconds (a tenth of the
        run).
    op_now : float, optional
        OP at rest where the set point is constant. None: the middle of the record's OP; else of the dead zone; else
        of the span.
    span : (float, float), optional
        Smallest and largest OP. None: that of the record, else 0 .. 100.
    samples, runs, seed : int
        Length where the set point does not give it, number of noise sequences, and their seed.
    draws : int
        Plants drawn from the covariance of the fit.
    cycle_samples : int
        Length of the noise-free runs in which limit cycles are sought.
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop, beside a fit: it must name the kind that was fitted.
    accept : str, optional
        Reason for which a closed gate is passed all the same; study and block keep it.

    Returns
    -------
    CompensationStudy

    Raises
    ------
    ParameterError
        An actuator without a block, no controller, a span that does not hold OP, a block with another scan time.
    GateError
        A fit that shows no lost motion, a diagnosis that says something else, or a model that does not reproduce the
        record, and no reason to accept it.
    DataError
        A record whose OP no PI explains.

    Examples
    --------
    >>> from lostmotion.models import Backlash, LinearModel
    >>> plant = Hammerstein(Backlash(2.0), LinearModel.from_continuous([1.0], [10.0, 1.0], 2.0, 0.5))
    >>> study = compensation_study(
    ...     plant, PI(2.0, 0.5), noise=1e-4, op_now=50.0, samples=300, runs=1, cycle_samples=600
    ... )
    >>> study.cases["with"].ratio < 0.5, len(study.mistakes)
    (True, 2)
    """
    found, seed = known(model, noise, diagnosis, accept), whole("seed", seed, 0)
    if block is None and isinstance(model, RecursiveEstimate):
        raise ParameterError.expected("a block beside an estimate in service", "none", "give the block in the PLC")
    record = None if record is None else as_record(record)
    span = _span(span, record, found)
    gains, source = _controller(controller, record)
    if op_now is not None:
        found = _resting_at(found, finite("op_now", op_now))
    gains = replace(gains, low=span[0], high=span[1])
    linear = found.plant.model.linear
    reference, described = _reference(found, record, reference, sp_step, hold, op_now, span, samples)
    deviation = _deviation(found.noise, linear.process_time / linear.dt)
    test = cycle_test(found.plant, gains, reference, deviation, whole("cycle_samples", cycle_samples, 300), span)
    found, compared = require_reproduction(found, gains, record, test.kick, seed, accept)
    op_noise = abs(gains.kp) * noise_of(noise_samples(found.noise, SAMPLES, seed))
    made_here = block is None and "factor" not in options
    block = _accepted(_block(found, span, op_noise, options) if block is None else _checked(block, linear.dt), found)
    swing = simulated_cycle(found.plant, gains, None, test, predicted_cycle(found.plant, gains, None))
    settle = settling_rows(block, swing.period / linear.dt)
    started = started_in_cycle(reference, settle, test.kick)
    noises = tuple(noise_samples(found.noise, started.size, seed + number) for number in range(whole("runs", runs, 1)))
    described += f", {reference.size * linear.dt:g} s a run, {len(noises)} runs"
    scenario = Scenario(started, noises, settle, span, BAND_IN_DEVIATIONS * op_noise, described)
    plants = mistakes(found, whole("draws", draws, 0), seed)
    tried = trial(found.plant, gains, block, scenario, test, plants, deviation)
    if made_here:
        tried = tried.or_safer(
            lambda factor: _accepted(_block(found, span, op_noise, {**options, "factor": factor}), found)
        )
    decision, block = tried.decision, tried.block
    chosen = {"runs": len(noises), "samples": int(reference.size), "draws": draws, "seed": seed, "span": list(span)}
    return CompensationStudy(
        recommendation=decision.word, reasons=decision.reasons, brief=decision.brief, useful=decision.useful,
        safe=decision.safe, cases=tried.cases,
        mistakes=tried.wrong, mistakes_retuned=tried.wrong_retuned, block=block, controller=gains,
        controller_source=source, model=found.plant.model, model_source=found.source, described=described,
        settle=settle, responses=tried.responses,
        settings={**chosen, "noise_deviation": deviation, "op_noise": op_noise}, reproduction=compared,
    )  # fmt: skip


def _span(span: tuple[float, float] | None, record: LoopRecord | None, found: Known) -> tuple[float, float]:
    if span is None:
        of_record = None if record is None else record.op_span
        span = of_record or (None if found.facts is None else found.facts.op_span) or PERCENT
    low, high = finite("span", span[0]), finite("span", span[1])
    if not low < high:
        raise ParameterError.expected("a span (low, high)", span, "turn it round")
    return low, high


def _controller(controller: PI | None, record: LoopRecord | None) -> tuple[PI, str]:
    if controller is not None:
        return controller, "given"
    if record is None:
        raise ParameterError.expected("a controller, or a record to estimate it from", "neither", "give kp and ki")
    return controller_of(record)


def _resting_at(found: Known, op_now: float) -> Known:
    """An integrating process given by numbers rests where OP is now."""
    if found.parameters or not found.plant.model.linear.integrates():
        return found
    return replace(found, plant=replace(found.plant, load=-float(np.asarray(found.plant.valve(op_now)))))


def _reference(
    found: Known,
    record: LoopRecord | None,
    given: npt.ArrayLike | None,
    step: float | None,
    hold: float | None,
    op_now: float | None,
    span: tuple[float, float],
    samples: int,
) -> tuple[FloatArray, str]:
    """Set point, and in words where it comes from."""
    dt = found.plant.model.linear.dt
    if given is not None:
        return finite_signal("reference", given), "set point as given"
    recorded = None if record is None or step is not None else longest_set_point(record)
    if record is not None and not abs(record.dt - dt) <= 1e-9 * dt:
        raise ParameterError.expected(f"a record with dt={dt}, as the fit's", record.dt, "identify this record")
    if recorded is not None:
        return recorded[-MOST_SAMPLES:], "set point of the record"
    if record is not None:
        level, where = float(np.nanmean(record.pv)), "the mean of the record's PV"
    else:
        level, where = _level(found, op_now, span)
    rest = found.plant.rest(level)[0]
    if not span[0] <= rest <= span[1]:
        raise ParameterError.expected(f"a span that holds OP at rest, {rest:.4g}", span, "give span and op_now")
    n = whole("samples", samples, 100)
    if step is None:
        return np.full(n, level), f"constant set point {level:.4g} ({where})"
    rows = max(round((0.1 * n * dt if hold is None else positive("hold", hold)) / dt), 1)
    size = finite("sp_step", step)
    return steps(level, size, n, rows), f"set point {level:.4g} with steps of {size:g} every {rows * dt:g} s"


def _level(found: Known, op_now: float | None, span: tuple[float, float]) -> tuple[float, str]:
    if op_now is not None:
        return found.plant.set_point_at(op_now), f"OP {op_now:.4g}"
    if found.plant.fault.static:
        return found.plant.model.offset, "inside the dead zone"
    middle, where = 0.5 * sum(found.op_range or span), "the record's" if found.op_range else "its span"
    return found.plant.set_point_at(middle), f"OP {middle:.4g}, the middle of {where}"


def _deviation(noise: NoiseModel, samples: float) -> float:
    """Deviation of the noise within the process time: a loop sees nothing of what drifts more slowly."""
    v = noise_samples(noise, 5 * SAMPLES, 0)
    lag = min(max(round(samples), 1), SAMPLES)
    return float(min(np.std(v), np.std(v[lag:] - v[:-lag]) / np.sqrt(2.0)))


def _block(found: Known, span: tuple[float, float], op_noise: float, options: dict[str, Any]) -> CompensatorBlock:
    """What the rules of ``fit.block()`` make, with the noise of OP that the controller makes of that of PV."""
    given = {"op_noise": op_noise, **options}
    if found.facts is not None:
        return block_from_fit(found.facts, span=span, accept=found.accepted or None, **given)
    linear = found.plant.model.linear
    given = {"process_time": linear.process_time, **given}
    return block_from_model(found.plant.valve, linear.dt, span=span, **given)


def _accepted(block: CompensatorBlock, found: Known) -> CompensatorBlock:
    return replace(block, accepted=found.accepted) if found.accepted else block


def _checked(block: CompensatorBlock, dt: float) -> CompensatorBlock:
    """A block that was given, for this sampling time."""
    if not abs(block.scan_time - dt) <= 1e-9 * dt:
        raise ParameterError.expected(f"a block with scan_time={dt}", block.scan_time, "make it for this dt")
    return block
