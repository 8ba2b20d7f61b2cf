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
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.cycles import (
    MOST_SAMPLES as MOST_CYCLE_SAMPLES,
)
from lostmotion.evaluate.study.cycles import (
    PERIODS_A_RUN,
    CycleTest,
    cycle_test,
    predicted_cycle,
    simulated_cycle,
)
from lostmotion.evaluate.study.mistakes import mistakes
from lostmotion.evaluate.study.recorded_controller import controller_of, longest_set_point
from lostmotion.evaluate.study.reproduced import require_reproduction
from lostmotion.evaluate.study.retuning import FEW_RUNS, retuned
from lostmotion.evaluate.study.scenario import NAMES, Scenario, started_in_cycle, steps
from lostmotion.evaluate.study.studied_loop import Known, known
from lostmotion.evaluate.study.study_plant import StudyPlant, noise_samples
from lostmotion.evaluate.study.study_result import CompensationStudy, LoopCase, MistakeCase
from lostmotion.evaluate.study.worth import decide
from lostmotion.identify import RatedEstimate, RecursiveEstimate
from lostmotion.kernels.threads import one_thread
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.records import LoopRecord
from lostmotion.records.movement import PERCENT
from lostmotion.records.white_noise import noise_of
from lostmotion.simulate import PI, LoopResponse

SAMPLES = 4000  # of a scenario made up here, where no record is given
MOST_SAMPLES = 20_000  # of a record's set point
FEWEST_SETTLE, MOST_SETTLE = 600, 4000
PERIODS = 4.0  # of a limit cycle until it has set in
BAND_IN_DEVIATIONS = 3.0  # of the noise in OP: one sample in 370 of Gaussian noise is outside
Model = Hammerstein | RatedEstimate | RecursiveEstimate | Mapping[str, Any]


@one_thread
def compensation_study(
    model: Model,
    controller: PI | None = None,
    *,
    record: LoopRecord | None = None,
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
    record : LoopRecord, optional
        Gives set point and controller where they are not given.
    noise : NoiseModel or float, optional
        Of PV, beside a bare model: model or variance of white noise.
    block : CompensatorBlock, optional
        What is to be downloaded. None: what ``fit.block()`` makes; `options` are passed on to it.
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
    found = known(model, noise, diagnosis, accept)
    if block is None and isinstance(model, RecursiveEstimate):
        raise ParameterError.expected("a block beside an estimate in service", "none", "give the block in the PLC")
    span = _span(span, record)
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
    block = _block(found, span, op_noise, options) if block is None else _checked(block, linear.dt)
    block = replace(block, accepted=found.accepted) if found.accepted else block
    swing = simulated_cycle(found.plant, gains, None, test, predicted_cycle(found.plant, gains, None))
    settle = _settle(block, swing.period / linear.dt)
    started = started_in_cycle(reference, settle, test.kick)
    noises = tuple(noise_samples(found.noise, started.size, seed + number) for number in range(whole("runs", runs, 1)))
    described += f", {reference.size * linear.dt:g} s a run, {len(noises)} runs"
    scenario = Scenario(started, noises, settle, span, BAND_IN_DEVIATIONS * op_noise, described)
    cases, responses = _cases(found.plant, gains, block, scenario, test)
    controllers = gains, cases["with, retuned"].controller
    slow = _long_enough(test, cases, linear.dt)
    pairs = [
        _mistakes(group, what, plant, controllers, block, scenario, slow)
        for group, what, plant in mistakes(found, whole("draws", draws, 0), seed)
    ]
    wrong, wrong_retuned = (tuple(pair[number] for pair in pairs) for number in (0, 1))
    decision = decide(cases, wrong, wrong_retuned, block, deviation)
    chosen = {"runs": len(noises), "samples": int(reference.size), "draws": draws, "seed": seed, "span": list(span)}
    return CompensationStudy(
        recommendation=decision.word, reasons=decision.reasons, safe=decision.safe, cases=cases, mistakes=wrong,
        mistakes_retuned=wrong_retuned, block=block, controller=gains, controller_source=source,
        model=found.plant.model, model_source=found.source, described=described, settle=settle, responses=responses,
        settings={**chosen, "noise_deviation": deviation, "op_noise": op_noise}, reproduction=compared,
    )  # fmt: skip


def _span(span: tuple[float, float] | None, record: LoopRecord | None) -> tuple[float, float]:
    if span is None:
        span = record.op_span if record is not None and record.op_span is not None else PERCENT
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


def _checked(block: CompensatorBlock, dt: float) -> CompensatorBlock:
    """A block that was given, for this sampling time."""
    if not abs(block.scan_time - dt) <= 1e-9 * dt:
        raise ParameterError.expected(f"a block with scan_time={dt}", block.scan_time, "make it for this dt")
    return block


def _settle(block: CompensatorBlock, period: float) -> int:
    """Rows until the offset is in force and a limit cycle has set in."""
    scans = block.settings["cap"] / max(block.settings["ramp_step"], 1e-12)
    periods = PERIODS * period if np.isfinite(period) else 0.0
    return int(min(max(2.0 * scans, periods, FEWEST_SETTLE), MOST_SETTLE))


def _cases(
    plant: StudyPlant, controller: PI, block: CompensatorBlock, scenario: Scenario, test: CycleTest
) -> tuple[dict[str, LoopCase], dict[str, LoopResponse]]:
    repaired = plant.with_valve(plant.fault.repaired(block))
    loops = {
        "without": (plant, controller, None),
        "with": (plant, controller, block),
        "retuned": (plant, retuned(plant, controller, None, scenario, test), None),
        "with, retuned": (plant, retuned(plant, controller, block, scenario, test), block),
        "no fault": (repaired, controller, None),
    }
    cases, responses, now = {}, {}, None
    for name, (one, pi, inverse) in loops.items():
        figures, responses[name] = scenario.run(one, pi, inverse)
        now = figures if now is None else now
        predicted = predicted_cycle(one, pi, inverse)
        cycle = simulated_cycle(one, pi, inverse, test, predicted)
        cases[name] = _case(figures, now, cycle, predicted, pi)
    return cases, responses


def _case(
    figures: FloatArray, now: FloatArray, cycle: LimitCycle, predicted: LimitCycle | None, controller: PI
) -> LoopCase:
    iae = NAMES.index("iae")
    ratios = figures[:, iae] / np.maximum(now[:, iae], 1e-300)
    error = float(np.std(ratios, ddof=1) / np.sqrt(ratios.size)) if ratios.size > 1 else 0.0
    ratio = float(figures[:, iae].mean() / max(now[:, iae].mean(), 1e-300))
    means = dict(zip(NAMES, figures.mean(axis=0).tolist(), strict=True))
    return LoopCase(**means, ratio=ratio, ratio_error=error, cycle=cycle, predicted=predicted, controller=controller)


def _long_enough(test: CycleTest, cases: Mapping[str, LoopCase], dt: float) -> CycleTest:
    """Runs that hold the slowest cycle of the estimated plant, with some room for others."""
    swings = [cycle for case in cases.values() for cycle in (case.cycle, case.predicted) if cycle is not None]
    slowest = max((cycle.period for cycle in swings if cycle.amplitude), default=0.0)
    return replace(test, samples=int(min(max(test.samples, 1.5 * PERIODS_A_RUN * slowest / dt), MOST_CYCLE_SAMPLES)))


def _mistakes(
    group: str, what: str, plant: StudyPlant, controllers: tuple[PI, PI], block: CompensatorBlock, scenario: Scenario,
    test: CycleTest,
) -> tuple[MistakeCase, MistakeCase]:  # fmt: skip
    """The block on one plant with the present controller, and with the retuned one."""
    iae, travel = NAMES.index("iae"), NAMES.index("travel")
    before = np.maximum(scenario.run(plant, controllers[0], None, FEW_RUNS)[0].mean(axis=0), 1e-300)
    cycle = simulated_cycle(plant, controllers[0], None, test)
    made = []
    for controller in controllers:
        after = scenario.run(plant, controller, block, FEW_RUNS)[0].mean(axis=0) / before
        swing = simulated_cycle(plant, controller, block, test)
        made.append(MistakeCase(group, what, float(after[iae]), float(after[travel]), cycle, swing, test.floor))
    return made[0], made[1]
