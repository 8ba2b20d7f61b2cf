"""How much records as plants have them cost: rounding, compression, holes, wild samples, sampling.

Run: ``.venv/bin/python benchmarks/records.py`` (about 30 minutes on one core); writes docs/records.md.
Options: ``--only NAME`` of a table, ``--seeds N``; then no page is written. Started again, it goes on after the last
table that was finished.
"""

from __future__ import annotations

import argparse
import functools
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from scipy.signal import lfilter

import lostmotion as lm
from historian import exceptions, swinging_door
from lostmotion.records import prepare, resample
from lostmotion.records.compression import compression
from pages import kept, publish

OUTPUT = Path(__file__).parent.parent / "docs" / "records.md"
TANK = lm.platforms.level_tank()
SIGMA = 0.03**0.5
ORDERS = {"nonlinearity": "dead zone", "orders": (3, 2, 3)}
TRUTH = np.array([-1.0, 1.0])
Signals = tuple[np.ndarray, np.ndarray]
Ends = tuple[np.ndarray, np.ndarray]


@functools.lru_cache(maxsize=256)
def signals(kind: str, n: int, seed: int, zone: bool = True) -> Signals:
    """OP and PV of the level tank: "open" with a pseudo-random command, else routine operation with that drift."""
    actuator = None if zone else lm.Identity()
    if kind != "open":
        loop = lm.routine_operation(n, kind, seed, actuator=actuator)
        return loop.command, loop.measured
    u = lm.signals.prs(n, -5, 5, hold=10, seed=seed)
    model = TANK if zone else lm.Hammerstein(lm.Identity(), TANK.linear.scaled(3.0))
    return u, model.simulate(u) + np.random.default_rng(seed + 10_000).normal(scale=SIGMA, size=n)


def ends(fit: lm.HammersteinFit) -> Ends:
    """Break points and their standard errors."""
    names = ("left", "right")
    return np.array([fit.parameters[name] for name in names]), np.array([fit.standard_errors[name] for name in names])


def line(*cells: object) -> str:
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def statuses(found: list[str]) -> str:
    return ", ".join(f"{name} {count}" for name, count in Counter(found).most_common())


def rounding(seeds: int) -> Iterator[str]:
    """Bias of the break points with PV rounded to steps, against the same record as it was."""
    for kind, n in (("open", 2000), ("none", 6000), ("mild", 6000), ("strong", 6000)):
        exact = [ends(lm.identify(*signals(kind, n, seed), 0.1, **ORDERS)) for seed in range(seeds)]
        for ratio in (0.1, 0.3, 1.0, 2.0, 2.5, 3.0, 4.0, 6.0):
            step, moved, misses, errors, told = ratio * SIGMA, [], [], [], 0
            for seed in range(seeds):
                u, y = signals(kind, n, seed)
                fit = lm.identify(u, np.round(y / step) * step, 0.1, **ORDERS)
                value, error = ends(fit)
                moved.append(value - exact[seed][0])
                misses.append(np.abs(value - TRUTH) <= 1.96 * error)
                errors.append(error)
                told += any(remark.startswith("Beware: PV was stored") for remark in fit.remarks)
            scale = np.median(errors, axis=0)
            bias, spread = np.mean(moved, axis=0) / scale, np.std(moved, axis=0) / scale / seeds**0.5
            shown = " / ".join(f"{b:+.2f} ({s:.2f})" for b, s in zip(bias, spread, strict=True))
            yield line(kind, n, ratio, shown, f"{100 * np.mean(misses):.0f}", f"{told}/{seeds}")


def archives(seeds: int) -> Iterator[str]:
    """Width from PV that a historian compressed."""
    n = 3000
    for title, squeeze in (("interpolated", swinging_door), ("held", exceptions)):
        for kind in ("open", "mild", "strong"):
            for deviation in (0.5, 1.0, 2.0, 3.0, 5.0):
                shares, widths, inside, found, verdicts, alarms = [], [], [], [], [], 0
                for seed in range(seeds):
                    u, y = signals(kind, n, seed)
                    record = lm.LoopRecord(u, squeeze(y, deviation * SIGMA), dt=0.1)
                    prepared = prepare(record)
                    shares.append(compression(record, "pv").share)
                    told = any("made up" in note for note in prepared.notes)
                    verdicts.append("told" if told else ("used" if prepared.usable else "refused"))
                    fit = lm.identify(record, raw=True, **ORDERS)
                    value, error = ends(fit)
                    widths.append(value[1] - value[0])
                    inside.append(np.abs(value - TRUTH) <= 1.96 * error)
                    found.append(fit.status.name)
                    u, y = signals(kind, n, seed, zone=False)
                    clean = lm.LoopRecord(u, squeeze(y, deviation * SIGMA), dt=0.1)
                    alarms += lm.identify(clean, raw=True, **ORDERS).preferred == "dead zone"
                width = f"{np.median(widths):.2f} ({np.min(widths):.2f} .. {np.max(widths):.2f})"
                yield line(
                    f"{title}, {kind}", deviation, f"{100 * np.mean(shares):.0f}", width,
                    f"{100 * np.mean(inside):.0f}", statuses(found), f"{alarms}/{seeds}", statuses(verdicts),
                )  # fmt: skip


def holes(seeds: int) -> Iterator[str]:
    """Break points from records with single rows of PV missing at random."""
    n = 6000
    for share in (0.0, 0.003, 0.01, 0.02, 0.05, 0.1):
        used, misses, inside, found = [], [], [], []
        for seed in range(seeds):
            u, y = signals("mild", n, seed)
            gone = np.random.default_rng(seed).random(n) < share
            prepared = prepare(lm.LoopRecord(u, np.where(gone, np.nan, y), dt=0.1))
            used.append(prepared.share)
            if not prepared.usable:
                found.append("refused")
                continue
            fit = lm.identify(prepared, **ORDERS)
            value, error = ends(fit)
            misses.append(value - TRUTH)
            inside.append(np.abs(value - TRUTH) <= 1.96 * error)
            found.append(fit.status.name)
        rmse = f"{np.sqrt(np.mean(np.square(misses))):.4f}" if misses else "-"
        cover = f"{100 * np.mean(inside):.0f}" if inside else "-"
        yield line(f"{100 * share:g}", f"{100 * np.mean(used):.0f}", rmse, cover, statuses(found))


def wild(seeds: int) -> Iterator[str]:
    """Break points with wild samples in PV, as they are and prepared."""
    n = 6000
    for count in (0, 3, 10, 30):
        for raw in (True, False):
            misses, inside, found = [], [], []
            for seed in range(seeds):
                u, y = signals("mild", n, seed)
                random = np.random.default_rng(seed)
                spoilt = y.copy()
                spoilt[random.choice(n, count, replace=False)] += random.choice([-20.0, 20.0], count) * SIGMA
                fit = lm.identify(lm.LoopRecord(u, spoilt, dt=0.1), raw=raw, **ORDERS)
                value, error = ends(fit)
                misses.append(value - TRUTH)
                inside.append(np.abs(value - TRUTH) <= 1.96 * error)
                found.append(fit.status.name)
            rmse = np.sqrt(np.mean(np.square(misses)))
            what = "as it is" if raw else "prepared"
            yield line(count, what, f"{rmse:.4f}", f"{100 * np.mean(inside):.0f}", statuses(found))


def tank(dt: float) -> lm.Hammerstein:
    """The level tank sampled otherwise."""
    v, t = (1.0, 5.0, 25.0), (1.0, 0.9)
    den = [1.0, v[1] + t[1], v[2] + v[1] * t[1], v[2] * t[1]]
    return lm.Hammerstein(TANK.nonlinearity, lm.LinearModel.from_continuous([50.0], den, dead_time=0.3 - dt, dt=dt))


def sampled(kind: str, dt: float, seconds: float, seed: int) -> Signals:
    """OP and PV at another sampling time, white noise of the same variance in every sample."""
    n, random, model = int(seconds / dt), np.random.default_rng(seed), tank(dt)
    if kind == "held OP":
        u = lm.signals.prs(n, -5, 5, hold=int(1.0 / dt), seed=seed)
    elif kind == "moving OP":
        pole = np.exp(-dt / 5.0)
        u = lfilter([2.5 * np.sqrt(1 - pole**2)], [1.0, -pole], random.normal(size=n))
    else:
        reference = np.repeat(random.choice([-1.0, 0.0, 1.0], n), int(30.0 / dt))[:n]
        pole = np.exp(-dt / 10.0)
        drift = lfilter([0.3 * np.sqrt(1 - pole**2)], [1.0, -pole], random.normal(size=n))
        controller = lm.PI(kp=0.5, ki=0.7, low=-50.0, high=50.0)
        loop = lm.simulate_loop(model, controller, reference, dt, disturbance=drift, noise=0.03, seed=random)
        return loop.command, loop.measured
    return u, model.simulate(u) + random.normal(scale=SIGMA, size=n)


def averaged(u: np.ndarray, y: np.ndarray, factor: int, dt: float) -> lm.LoopRecord:
    """The tempting way: OP averaged over its block as PV is."""
    slower = resample(lm.LoopRecord(u, y, dt=dt), factor)
    starts = np.arange(factor, len(slower) * factor + 1, factor)
    op = np.array([u[start : start + factor].mean() for start in starts])
    return lm.LoopRecord(op, slower.pv, dt=slower.dt)


def every(u: np.ndarray, y: np.ndarray, factor: int, dt: float) -> lm.LoopRecord:
    """A record that keeps every so many rows only."""
    return lm.LoopRecord(u[::factor], y[::factor], dt=dt * factor)


def row_of(make: Callable[[int], lm.LoopRecord], seeds: int) -> tuple[str, ...]:
    misses, inside, found = [], [], []
    for seed in range(seeds):
        fit = lm.identify(make(seed), raw=True, nonlinearity="dead zone")
        value, error = ends(fit)
        misses.append(value - TRUTH)
        inside.append(np.abs(value - TRUTH) <= 1.96 * error)
        found.append(fit.status.name)
    rmse, middle = np.sqrt(np.mean(np.square(misses))), np.median(np.abs(misses))
    return f"{rmse:.4f}", f"{middle:.4f}", f"{100 * np.mean(inside):.0f}", statuses(found)


def fast(seeds: int) -> Iterator[str]:
    """Sampling of 0.02 s, five times faster than the paper's, as it is and resampled; everything "auto"."""
    seeds = max(seeds // 3, 2)
    for kind, seconds in (("held OP", 200.0), ("moving OP", 200.0), ("loop", 400.0)):
        made = functools.lru_cache(maxsize=None)(functools.partial(sampled, kind, 0.02, seconds))
        yield line(kind, "as it is", 1, *row_of(lambda seed, m=made: lm.LoopRecord(*m(seed), dt=0.02), seeds))
        for factor in (5, 10):
            for what, change in (("resample", None), ("OP averaged too", averaged)):

                def slower(seed: int, m=made, f=factor, c=change) -> lm.LoopRecord:
                    u, y = m(seed)
                    return resample(lm.LoopRecord(u, y, dt=0.02), f) if c is None else c(u, y, f, 0.02)

                yield line(kind, what, factor, *row_of(slower, seeds))


def slow(seeds: int) -> Iterator[str]:
    """Every so many rows of the paper's loop; everything "auto"."""
    seeds = max(seeds // 3, 2)
    for kind in ("held OP", "loop"):
        for factor in (1, 5, 10, 20, 40):
            seconds = 200.0 * factor

            def kept(seed: int, k=kind, f=factor, s=seconds) -> lm.LoopRecord:
                return every(*sampled(k, 0.1, s, seed), f, 0.1)

            yield line(kind, f"{0.1 * factor:g}", f"{1.11 / (0.1 * factor):.2g}", *row_of(kept, seeds))


TABLES = {"rounding": rounding, "archives": archives, "holes": holes, "wild": wild, "fast": fast, "slow": slow}


def told(name: str, seeds: int) -> list[str]:
    """Rows of a table, each shown when it is there."""
    rows = []
    for row in TABLES[name](seeds):
        print(name, row, flush=True)
        rows.append(row)
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=24)
    parser.add_argument("--only", choices=list(TABLES))
    arguments = parser.parse_args()
    done = {}
    for name in [arguments.only] if arguments.only else TABLES:
        key = f"{name} {arguments.seeds} seeds"
        done[name] = "\n".join(kept("records", key, lambda n=name: told(n, arguments.seeds)))
    if not arguments.only and arguments.seeds == 24:
        publish(OUTPUT, PAGE.format(**done))


PAGE = """# Records as plants have them

Made by `.venv/bin/python benchmarks/records.py`. Paper's level tank, dead zone +-1, white measurement noise of
deviation 0.173; "open" is a pseudo-random command, "none", "mild" and "strong" are routine closed-loop operation with
that drift. 24 seeds a row, a third of that in the last two tables. The thresholds of `prepare` and of the remarks of a
fit stand in `records/limits.py` and `report/remarks_on_fit.py`; these tables are their reason.

## PV rounded to a step

Bias of left / right against the same record before rounding, in standard errors, with the error of that mean in
brackets; coverage of the 95 % intervals; how often the fit says that its break points may be off ("Beware").

| operation | rows | step / noise | bias, standard errors | coverage, % | said |
|---|---|---|---|---|---|
{rounding}

## PV from a compressed archive

Dead band in deviations of the noise. Found: share of the rows that are recognised as made up. Median width (truth 2)
with its extremes, coverage of the break points and status as if the archive were believed (`raw`), how often a dead
zone is claimed where there is none, and what `prepare` does.

| archive | dead band / noise | found, % | width | coverage, % | status | false alarms | prepare |
|---|---|---|---|---|---|---|---|
{archives}

## Single rows missing

6,000 rows of routine operation with mild drift; rows of PV missing at random. They are bridged, each by its most likely
value given the rows around it (`lostmotion.records.missing`); of more than a fifth of the rows none is.

| missing, % | rows used, % | RMSE of the break points | coverage, % | status |
|---|---|---|---|---|
{holes}

## Wild samples of PV

The same operation; single samples 20 deviations of the noise off.

| wild samples | record | RMSE of the break points | coverage, % | status |
|---|---|---|---|---|
{wild}

## Sampling that is fast

0.02 s for a time constant of 1.1 s. "OP averaged too" is what `resample` does not do: in closed loop OP answers to the
noise of PV, and its mean over a block must not be compared with the mean of PV over the same rows.

| operation | record | factor | RMSE | median error | coverage, % | status |
|---|---|---|---|---|---|---|
{fast}

## Sampling that is slow

Every so many rows of a record at 0.1 s are kept, the number of rows is the same.

| operation | sampling time, s | samples in the time constant | RMSE | median error | coverage, % | status |
|---|---|---|---|---|---|---|
{slow}
"""


if __name__ == "__main__":
    main()
