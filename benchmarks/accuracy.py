"""Accuracy of ``identify`` over many seeds, beside the Cramer-Rao bound.

Run: ``.venv/bin/python benchmarks/accuracy.py`` (about 5 minutes on two cores); writes docs/accuracy.md.
Options: ``--seeds N`` for a smaller run, ``--only NAME`` for one experiment.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion.evaluate import cramer_rao
from pages import publish

NAMES = ("left", "right", "slope_ratio")
OUTPUT = Path(__file__).parent.parent / "docs" / "accuracy.md"
TANK = lm.platforms.level_tank()
FAILED = ("REFUSED", "NOT_CONVERGED", "CANNOT_TELL")


@dataclass(frozen=True)
class Experiment:
    """One row of the table: how a record is made, how it is identified, what is true."""

    title: str
    record: Callable[[int], tuple[np.ndarray, np.ndarray]]
    truth: lm.Hammerstein
    seeds: int
    options: dict
    bound: bool = True
    wrong: bool = False  # a model too poor for the record: a refusal is a miss of the row, not the end of the page


def open_loop(n: int, model: lm.Hammerstein = TANK, low: float = -5.0, high: float = 5.0):
    def record(seed: int):
        u = lm.signals.prs(n, low, high, hold=10, seed=seed)
        return u, model.simulate(u) + np.random.default_rng(seed + 10_000).normal(scale=0.03**0.5, size=n)

    return record


def routine(n: int, drift: str):
    def record(seed: int):
        loop = lm.routine_operation(n, drift, seed)
        return loop.command, loop.measured

    return record


ASYMMETRIC = lm.Hammerstein(lm.DeadZone(2.0, 4.3, 4.0, 1.0), TANK.linear, offset=12.0)
NO_ZONE = lm.Hammerstein(lm.Identity(), TANK.linear)
PAPER = {"orders": (3, 2, 3), "gain": TANK.linear.gain}
EXPERIMENTS = {
    "open-2000": Experiment("open loop, PRS, N = 2,000, orders given", open_loop(2000), TANK, 100, PAPER),
    "open-20000": Experiment("open loop, PRS, N = 20,000, orders given", open_loop(20_000), TANK, 100, PAPER),
    "open-2000-auto": Experiment("open loop, PRS, N = 2,000, everything auto", open_loop(2000), TANK, 100, {}),
    "asymmetric": Experiment(
        "asymmetric (2.0 .. 4.3, slopes 4 and 1, offset 12), N = 2,000",
        open_loop(2000, ASYMMETRIC, -2.0, 9.0), ASYMMETRIC, 100, {"orders": (3, 2, 3), "gain": TANK.linear.gain},
    ),
    "routine-none": Experiment(
        "routine closed loop, white noise, N = 6,000", routine(6000, "none"), TANK, 50, PAPER, False
    ),
    "routine-mild": Experiment("routine closed loop, mild drift", routine(6000, "mild"), TANK, 50, PAPER, False),
    "routine-strong": Experiment(
        "routine closed loop, strong drift", routine(6000, "strong"), TANK, 50, PAPER, False
    ),
    "routine-very-strong": Experiment(
        "routine closed loop, very strong drift", routine(6000, "very strong"), TANK, 50, PAPER, False
    ),
    "routine-strong-auto": Experiment(
        "routine closed loop, strong drift, everything auto", routine(6000, "strong"), TANK, 50, {}, False
    ),
    "routine-strong-white": Experiment(
        "routine closed loop, strong drift, fitted as the paper's Output Error model",
        routine(6000, "strong"), TANK, 50, {**PAPER, "noise": "white"}, False, True,
    ),
    "routine-mild-white": Experiment(
        "routine closed loop, mild drift, fitted as the paper's Output Error model",
        routine(6000, "mild"), TANK, 50, {**PAPER, "noise": "white"}, False, True,
    ),
}  # fmt: skip


def one(name: str, seed: int) -> dict[str, np.ndarray | str]:
    """Estimates, standard errors and bounds of one seed; NaN and "REFUSED" where no model comes of it."""
    experiment = EXPERIMENTS[name]
    u, y = experiment.record(seed)
    try:
        fit = lm.identify(u, y, 0.1, **experiment.options, nonlinearity="dead zone")
    except lm.InputError:
        if not experiment.wrong:
            raise
        nothing = np.full(len(NAMES), np.nan)
        return {"status": "REFUSED", "estimate": nothing, "error": nothing, "bound": nothing}
    bounds = {}
    if experiment.bound:
        known = "zero" if fit.settings["offset_fixed"] else "free"
        bounds = cramer_rao(experiment.truth, u, 0.03, gain=experiment.options.get("gain"), offset=known)
    return {
        "status": fit.status.name,
        "estimate": np.array([fit.parameters[key] for key in NAMES]),
        "error": np.array([fit.standard_errors[key] for key in NAMES]),
        "bound": np.array([bounds.get(key, np.nan) for key in NAMES]),
    }


def true_values(model: lm.Hammerstein) -> np.ndarray:
    zone = model.nonlinearity
    return np.array([zone.left, zone.right, zone.left_slope / zone.right_slope])


def row(name: str, results: list[dict]) -> str:
    """One line of the table; a refusal is a miss of every interval and the largest of all errors."""
    experiment = EXPERIMENTS[name]
    truth = true_values(experiment.truth)
    estimate, error, bound = (np.array([result[key] for result in results]) for key in ("estimate", "error", "bound"))
    miss = estimate - truth
    rmse = np.sqrt(np.nanmean(miss**2, axis=0))
    ratio = rmse / np.sqrt(np.mean(bound**2, axis=0))
    cover = np.mean(np.abs(miss) <= 1.96 * error, axis=0)
    half = 0.5 * (truth[1] - truth[0])
    median = np.median(np.nan_to_num(np.abs(miss[:, :2]), nan=np.inf)) / half
    limit = 0.6745 * np.sqrt(np.nanmedian(error[:, :2] ** 2)) / half
    converged = sum(result["status"] not in FAILED for result in results)
    refused = sum(result["status"] == "REFUSED" for result in results)
    cells = [
        experiment.title + (f" ({refused} of {len(results)} refused: a gain of the other sign)" if refused else ""),
        f"{converged}/{len(results)}",
        " / ".join(f"{value:.4f}" for value in rmse),
        " / ".join(f"{value:.2f}" for value in ratio) if experiment.bound else "-",
        f"{100 * median:.2f} % ({100 * limit:.2f} %)",
        " / ".join(f"{100 * value:.0f}" for value in cover),
    ]
    return "| " + " | ".join(cells) + " |"


def null_row(seeds: int, pool: ProcessPoolExecutor) -> str:
    """No dead zone in the data: how often it says so."""
    lines = []
    for title, drift in (
        ("open loop, PRS, N = 2,000", None),
        ("routine closed loop, mild drift, N = 6,000", "mild"),
    ):
        said = sum(pool.map(says_none, range(seeds), [drift] * seeds))
        lines.append(f"| {title} | {said}/{seeds} |")
    return "\n".join(lines)


def says_none(seed: int, drift: str | None) -> bool:
    if drift is None:
        u, y = open_loop(2000, NO_ZONE)(seed)
    else:
        loop = lm.routine_operation(6000, drift, seed, actuator=lm.Identity())
        u, y = loop.command, loop.measured
    fit = lm.identify(u, y, 0.1, orders=(3, 2, 3), nonlinearity="dead zone")
    low, _ = fit.interval("width")
    return fit.preferred == "none" and low <= 0.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=None)
    parser.add_argument("--only", choices=list(EXPERIMENTS), default=None)
    arguments = parser.parse_args()
    lines = []
    with ProcessPoolExecutor(2) as pool:
        for name in [arguments.only] if arguments.only else EXPERIMENTS:
            seeds = arguments.seeds or EXPERIMENTS[name].seeds
            lines.append(row(name, list(pool.map(one, [name] * seeds, range(seeds), chunksize=2))))
            print(lines[-1], flush=True)
        if arguments.only:
            return
        null = null_row(arguments.seeds or 100, pool)
        print(null)
    if arguments.seeds is None:
        publish(OUTPUT, PAGE.format(rows="\n".join(lines), null=null))


PAGE = """# Accuracy of `identify`

Made by `.venv/bin/python benchmarks/accuracy.py`. Paper's level tank, dead zone +-1, sampling time 0.1 s, white
noise of variance 0.03; no start values anywhere. RMSE and ratio to the Cramer-Rao bound are for
left / right / slope ratio. The median error of the break points is in % of the half-width; in brackets what an
efficient estimator with the reported standard errors would have, so the data do not allow less. Coverage is of the
nominal 95 % intervals.

| experiment | converged | RMSE | RMSE / bound | median error | coverage, % |
|---|---|---|---|---|---|
{rows}

The bound counts the initial state and, where the fit kept it free, the output offset as unknown. In closed
loop with drift it depends on the record and is not shown; the bracketed figure takes its place.

The drift of the routine loop is first-order with pole 0.99; its deviation is 0.3 (mild), 1 (strong) or 3 (very
strong) times a set-point move. The last rows show what the same data give without a noise model; where such a fit
ends at a process of the other sign than the gain given, `identify` refuses it: a miss of all three intervals, and the
RMSE is of the others.

No dead zone in the data; how often `identify` says so (linear model preferred, the interval of the width holds 0):

| experiment | says so |
|---|---|
{null}
"""


if __name__ == "__main__":
    main()
