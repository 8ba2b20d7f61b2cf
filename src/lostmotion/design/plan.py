"""``design``: the test that is worth asking for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lostmotion.arguments import finite, whole
from lostmotion.arrays import FloatArray
from lostmotion.compensate.gate import Said
from lostmotion.design.bound import expected
from lostmotion.design.comparison import prs_by_hold
from lostmotion.design.design_criterion import Criterion
from lostmotion.design.designed import Prediction, TestDesign
from lostmotion.design.length import shortest
from lostmotion.design.operating_limits import NOISE_MARGIN, Range
from lostmotion.design.plausible_plants import SPREAD
from lostmotion.design.prior import Known, known
from lostmotion.design.relax import advice
from lostmotion.design.request import FEWEST_SAMPLES, TARGETS, Asked, check
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase
from lostmotion.design.task import ASSURED, Task
from lostmotion.errors import ParameterError
from lostmotion.identify import RatedEstimate
from lostmotion.kernels.threads import one_thread
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.simulate import PI

PLANTS, FRESH = 8, 16  # plausible plants of the search, and of the judgement
GROWTH_POINTS = 24  # of the curve in figure and report; each costs a likelihood per plant
REACH = 3.0  # widths of the dead zone: deviation of the break points before the test, at least


@one_thread
def design(
    model: Hammerstein | RatedEstimate | Mapping[str, Any],
    noise: NoiseModel | float | None = None,
    *,
    op_limits: Range | None = None,
    op_now: float | None = None,
    pv_now: float | None = None,
    pv_limits: Range | None = None,
    sp_limits: Range | None = None,
    rate_limit: float | None = None,
    shortest_hold: float | None = None,
    duration: float | None = None,
    wanted: Mapping[str, float] | None = None,
    target: str = "width",
    loop: str = "open",
    controller: PI | None = None,
    spread: float = SPREAD,
    seed: int = 0,
    effort: float = 1.0,
    progress: Callable[[str], None] | None = None,
    diagnosis: Said | None = None,
    accept: str | None = None,
) -> TestDesign:
    """Design the test that tells most about the dead zone in the time that the operator gives.

    A staircase of OP (or of SP in closed loop) is sought that maximises the Fisher information about the width, or
    about what is `wanted`, with everything else unknown: process, slopes, offset, initial state and, in closed loop,
    noise model. It is made for many plausible plants at once, not for the model as given, and keeps the limits on all
    of them.

    Parameters
    ----------
    model : Hammerstein, HammersteinFit, FitFacts or mapping
        Rough model with a :class:`DeadZone`, or a fit (or its ``to_dict()``), which brings its noise and covariance.
    noise : NoiseModel or float
        Noise of PV, or the variance of white noise, beside a Hammerstein.
    op_limits : (float, float)
        What OP must not leave; required in open loop.
    op_now : float, optional
        OP at which the plant rests before the test. Default: the middle of its limits (open loop), the bias of the
        controller, or the middle of the dead zone; said in the result.
    pv_now : float, optional
        PV at rest before the test: the test starts from there, whatever the offset of the model is. Default: that of
        the model at `op_now`.
    pv_limits : (float, float), optional
        What PV must not leave, noise included (three deviations in open loop); required where the process integrates.
    sp_limits : (float, float)
        Range of SP; required in closed loop.
    rate_limit : float, optional
        Fastest move of OP (open loop) or SP (closed loop), units per second.
    shortest_hold : float, optional
        Seconds for which a level is kept at least. Default: a third of delay plus dominant time constant.
    duration : float, optional
        Seconds; with `wanted` the most that may be used.
    wanted : dict of float, optional
        Half-width of the 95 % interval by name ("left", "right", "width"), in units of OP: the shortest test that
        reaches all of them, on the model as given and on four plausible plants in five, and misses them on none by
        more than three times.
    target : {"width", "break points"}
        Without `wanted`: whose interval is to be the smallest. The best test for the width alone can leave open where
        the dead zone lies; "break points" asks for the smaller of the worse of `left` and `right`.
    loop : {"open", "closed"}
    controller : PI, for a closed loop
    spread : float
        Roughness of a guess: break points within this share of the half-width, slopes, gain and time constants within
        this share. A fit brings its own.
    seed : int
        Of the search and of the simulated noise: the same seed, the same test.
    effort : float
        Work of the search, 1 is normal (seconds).
    progress : callable, optional
        Is given a line on what is done next.
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop, beside a fit: it must name the dead zone.
    accept : str, optional
        Reason for which a fit that shows no dead zone is taken all the same; the result keeps it.

    Returns
    -------
    TestDesign
        Look at `reached` first; `advice` says what would have to be relaxed.

    Raises
    ------
    ParameterError
        Limits that contradict each other or the model, a missing noise, neither duration nor wanted.
    GateError
        A fit that shows no dead zone, or a diagnosis that says something else, and no reason to accept it.

    Notes
    -----
    Optimal experiment design as in Ljung, *System Identification*, 2nd ed., chapter 13; robust to a rough model in the
    manner of Pronzato and Walter, Mathematical Biosciences 75 (1985). The signal is found by exchange of levels and
    holds; see docs/test-design.md for what else was tried.

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> test = lm.design(tank, 0.03, op_limits=(-5, 5), shortest_hold=1.0, duration=60.0, effort=0.02)
    >>> test.reached, test.expected["width"] < test.prs_expected["width"]
    (True, True)
    """
    if not 0 < finite("spread", spread) < 0.9:
        raise ParameterError.expected("0 < spread < 0.9", spread, "0.3 means plus or minus 30 %")
    if not finite("effort", effort) > 0:
        raise ParameterError.expected("effort > 0", effort, "1 is normal")
    seed = whole("seed", seed, 0)
    rough = known(model, noise, spread, diagnosis, accept)
    asked = check(
        rough, loop=loop, controller=controller, op_limits=op_limits, sp_limits=sp_limits, pv_limits=pv_limits,
        op_now=op_now, pv_now=pv_now, rate_limit=rate_limit, shortest_hold=shortest_hold, duration=duration,
        wanted=wanted, target=target, seed=seed,
    )  # fmt: skip
    task = _task(rough, asked, seed, effort)
    tell = progress or _silent
    stairs, reached = _solve(task, asked, tell)
    settings = {
        "seed": seed,
        "effort": effort,
        "plants": len(task.plants) + len(task.fresh),
        "roughness": rough.roughness,
        "assumed": list(asked.assumed),
        **({"accepted": rough.accepted} if rough.accepted else {}),
    }
    said: tuple[str, ...] = ()
    if not reached:
        tell("looking for limits to relax")
        said = advice(task, stairs, lambda times: _task(rough.better(times), asked, seed, effort))
    tell("working out what it tells")
    return _package(task, asked, stairs, reached, said, settings)


def _silent(line: str) -> None: ...


def _task(rough: Known, asked: Asked, seed: int, effort: float) -> Task:
    """The model as given and plausible others, all at rest where the loop stands now."""
    given = asked.plant

    def made(models: list[Hammerstein], first: int) -> list[Plant]:
        return [
            replace(given, model=model, seed=seed + first + at).anchored(given.pv_now)
            for at, model in enumerate(models)
        ]

    reach = max(REACH * given.zone.width, *(abs(end - given.op_now) for end in _op_range(asked)))
    return Task(
        [given, *made(rough.plausible(PLANTS, seed), 1)],
        made(rough.extremes(), 1001),
        made(rough.fresh(FRESH, seed), 2001),
        asked.limits,
        Criterion(asked.wanted or dict.fromkeys(TARGETS[asked.target], 1.0), reach, given.zone.width),
        seed,
        asked.wanted is not None,
        effort,
    )


def _op_range(asked: Asked) -> Range:
    return asked.limits.levels if asked.plant.controller is None else (asked.plant.op_now, asked.plant.op_now)


def _solve(task: Task, asked: Asked, tell: Callable[[str], None]) -> tuple[Staircase, bool]:
    """Best staircase, and whether it reaches what was wanted; without a goal, whether it tells anything."""
    if asked.samples is None:
        return shortest(task, asked.fewest, asked.most, tell)
    tell("searching")
    stairs = task.best(asked.samples)
    found = expected(task.plants[0], task.signal(stairs), seeds=1)
    return stairs, all(np.isfinite(found[name]) for name in task.criterion.wanted)


def _package(
    task: Task, asked: Asked, stairs: Staircase, reached: bool, said: tuple[str, ...], settings: dict[str, Any]
) -> TestDesign:
    """Figures of the design on the full clock, for the model as given and over the plausible plants."""
    given, limits, dt = task.plants[0], task.limits, task.plants[0].model.linear.dt
    signal = task.signal(stairs)
    own = expected(given, signal)
    several = [expected(plant, signal, seeds=1) for plant in task.plants + task.fresh]
    names = [name for name in own if all(name in one for one in several)]
    table = np.array([[one[name] for name in names] for one in several])
    ratios = {name: own[name] / goal for name, goal in task.criterion.wanted.items()}
    target = max(ratios, key=lambda name: ratios[name])
    rivals = prs_by_hold(task.everyone, limits, stairs.samples, settings["seed"])
    moves = stairs.merged()
    starts = np.concatenate([[0], np.cumsum(moves.lengths)[:-1]]) * dt
    return TestDesign(
        signal=signal,
        dt=dt,
        loop="open" if given.controller is None else "closed",
        steps=tuple(zip(starts.tolist(), moves.levels.tolist(), strict=True)),
        expected=own,
        expected_typical=dict(zip(names, np.median(table, axis=0).tolist(), strict=True)),
        expected_worst=dict(zip(names, table.max(axis=0).tolist(), strict=True)),
        prs_expected=rivals[limits.hold],
        prs_by_hold={hold * dt: values for hold, values in rivals.items()},
        goals=task.criterion.wanted,
        target=target,
        growth=_growth(task, signal, target),
        wanted=asked.wanted,
        reached=reached,
        reached_by=float(np.mean([_reaches(one, asked.wanted) for one in several])),
        advice=said,
        break_points={name: _ends(task, name) for name in ("left", "right")},
        prediction=_prediction(task, signal),
        model=given.model,
        noise=given.noise,
        controller=given.controller,
        op_now=given.op_now,
        limits=limits,
        settings=settings,
    )


def _reaches(half_widths: dict[str, float], wanted: dict[str, float] | None) -> bool:
    return all(half_widths[name] <= goal for name, goal in (wanted or {}).items())


def _ends(task: Task, name: str) -> tuple[float, float]:
    ends = [getattr(plant.zone, name) for plant in task.plants + task.fresh]
    return min(ends), max(ends)


def _growth(task: Task, signal: FloatArray, target: str) -> dict[str, FloatArray]:
    """Half-width of the target after some time, more and more; infinite while it is not known."""
    rows = np.unique(np.linspace(min(FEWEST_SAMPLES, signal.size), signal.size, GROWTH_POINTS).astype(int))
    criterion = replace(task.criterion, wanted={target: 1.0})
    trials = [(plant, *plant.trial(signal)) for plant in task.plants + task.fresh]
    table = np.array(
        [[criterion.half_widths(plant, op[:row], pv[:row])[0] for plant, op, pv in trials] for row in rows]
    )
    table[table > criterion.reach] = np.inf
    enough = np.sort(table, axis=1)[:, int(np.ceil(ASSURED * table.shape[1])) - 1]
    return {"time_s": rows * task.plants[0].model.linear.dt, "model": table[:, 0], "assured": enough}


def _prediction(task: Task, signal: FloatArray) -> Prediction:
    given = task.plants[0]
    quiet = replace(given, noise=NoiseModel((), 0.0))
    op, pv = quiet.trial(signal)
    trials = [plant.trial(signal) for plant in task.everyone]
    room = NOISE_MARGIN * given.noise_deviation if given.controller is None else 0.0
    ops, pvs = (np.array([trial[which] for trial in trials]) for which in (0, 1))
    return Prediction(op, pv, pvs.min(axis=0) - room, pvs.max(axis=0) + room, ops.min(axis=0), ops.max(axis=0))
