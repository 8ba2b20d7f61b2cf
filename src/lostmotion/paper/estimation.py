"""The estimation experiment: table 1 and figure 9, for the paper's method and the others."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from lostmotion.arguments import whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.evaluate.workers import run_all
from lostmotion.identify import RecursiveIV, identify
from lostmotion.paper.published import GAIN, TABLE_1
from lostmotion.paper.voros import voros
from lostmotion.simulate import platforms, signals
from lostmotion.simulate.platforms.level_tank import DT, NOISE_VARIANCE

METHODS = ("riv", "rls", "els", "voros", "ml")
NAMES = tuple(TABLE_1)
ZONE = ("left", "right", "left_slope", "right_slope")
TOLERANCE = {"left": 0.3, "right": 0.3, "left_slope": 0.5, "right_slope": 0.5}  # what counts as converged
WITHIN = 0.1  # of the true value: the band of the convergence time
ROWS = 200  # points of a trajectory


@dataclass(frozen=True)
class Run:
    """One seed of one method: estimates and standard errors by name; the zone along the run where recursive."""

    method: str
    seed: int
    estimate: dict[str, float]
    standard_errors: dict[str, float]
    samples: FloatArray
    trajectory: FloatArray
    polynomials: FloatArray

    @property
    def converged(self) -> bool:
        """All four parameters of the dead zone near their true values."""
        return all(abs(self.estimate[name] - TABLE_1[name][1]) <= reach for name, reach in TOLERANCE.items())

    @property
    def convergence_time(self) -> float:
        """Seconds after which all four stay within 10 % of the truth; infinite if they do not, NaN for batch fits."""
        if not self.samples.size:
            return float("nan")
        truth = np.array([TABLE_1[name][1] for name in ZONE])
        outside = np.any(np.abs(self.trajectory - truth) > WITHIN * np.abs(truth), axis=1)
        if outside[-1]:
            return float("inf")
        last = int(np.flatnonzero(outside)[-1]) + 1 if outside.any() else 0
        return float(self.samples[last] * DT)


@dataclass(frozen=True)
class EstimationStudy:
    """All seeds of all methods."""

    samples: int
    runs: dict[str, list[Run]]

    def spread(self, method: str, name: str) -> tuple[float, float, float]:
        """Mean, standard deviation and RMSE of one parameter over the converged seeds."""
        values = np.array([run.estimate[name] for run in self.runs[method] if run.converged])
        if not values.size:
            return float("nan"), float("nan"), float("nan")
        miss = values - _truth(name)
        return float(values.mean()), float(values.std()), float(np.sqrt(np.mean(miss**2)))

    def summary(self, method: str) -> dict[str, Any]:
        """Converged seeds, RMSE of all parameters, median convergence time."""
        runs = self.runs[method]
        times = np.array([run.convergence_time for run in runs])
        known = times[~np.isnan(times)]
        return {
            "seeds": len(runs),
            "converged": sum(run.converged for run in runs),
            "rmse": {name: self.spread(method, name)[2] for name in NAMES},
            "mean": {name: self.spread(method, name)[0] for name in NAMES},
            "standard_error": {
                name: float(np.median([run.standard_errors.get(name, np.nan) for run in runs])) for name in NAMES
            },
            "convergence_time_s": float(np.median(known)) if known.size else None,
        }


def study_estimation(
    seeds: int = 20,
    samples: int = 200_000,
    methods: tuple[str, ...] = METHODS,
    processes: int | None = None,
) -> EstimationStudy:
    """Repeat the paper's estimation experiment.

    Parameters
    ----------
    seeds : int
        Runs of each method.
    samples : int
        Samples of 0.1 s in each; the paper has 200,000.
    methods : tuple of {"riv", "rls", "els", "voros", "ml"}
        The paper's, its least-squares relatives, Voros's batch iteration, and ``identify``.
    processes : int, optional
        Side by side; default all cores.
    """
    unknown = set(methods) - set(METHODS)
    if unknown or not methods:
        raise ParameterError.expected(f"methods among {list(METHODS)}", sorted(unknown), "choose one of them")
    seeds, samples = whole("seeds", seeds, 1), whole("samples", samples, 1000)
    jobs = [(method, seed, samples) for method in methods for seed in range(seeds)]
    jobs.sort(key=lambda job: job[0] != "ml")  # the longest first
    done = run_all(_one, jobs, "table 1, figure 9", processes)
    return EstimationStudy(samples, {name: [run for run in done if run.method == name] for name in methods})


def experiment(seed: int, samples: int) -> tuple[FloatArray, FloatArray]:
    """Command and noisy output of one run: PRS 45 .. 55 % in deviations, noise variance 0.03."""
    tank = platforms.level_tank()
    u = signals.prs(samples, -5.0, 5.0, hold=10, seed=seed)
    noise = np.random.default_rng(seed + 10_000).normal(scale=np.sqrt(NOISE_VARIANCE), size=samples)
    return u, tank.simulate(u) + noise


def _one(job: tuple[str, int, int]) -> Run:
    method, seed, samples = job
    u, y = experiment(seed, samples)
    nothing = np.empty(0)
    if method in ("riv", "rls", "els"):
        estimator = RecursiveIV(3, 2, 3, GAIN, dt=DT, method=method)
        trajectory = estimator.run(u, y, every=max(samples // ROWS, 1))
        found = estimator.estimate
        path = np.column_stack([trajectory[name] for name in ZONE])
        return Run(
            method, seed, found.parameters, found.standard_errors, trajectory.samples.astype(float), path,
            trajectory["theta"][:, :9],
        )  # fmt: skip
    if method == "voros":
        return Run(method, seed, voros(u, y, (3, 2, 3), GAIN, DT).parameters, {}, nothing, nothing, nothing)
    fit = identify(u, y, DT, orders=(3, 2, 3), noise="white", gain=GAIN, nonlinearity="dead zone")
    return Run(method, seed, fit.parameters, fit.standard_errors, nothing, nothing, nothing)


def _truth(name: str) -> float:
    """True value to full precision; the paper prints four digits."""
    tank = platforms.level_tank()
    linear = {f"a{i + 1}": value for i, value in enumerate(tank.linear.a)}
    linear |= {f"b{i}": value for i, value in enumerate(tank.linear.b)}
    return linear.get(name, TABLE_1[name][1])
