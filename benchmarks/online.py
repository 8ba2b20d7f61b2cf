"""Online estimators beside what a user would pick instead: accuracy and speed on the same data, in the same run.

Run: ``.venv/bin/python benchmarks/online.py`` (about 10 minutes, one thread but for the many loops); writes
docs/online.md. The rivals are installed into ``.venv-rivals`` on the first run. Option: ``--quick`` for a tenth of
the seeds, which writes nothing.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported

import argparse  # noqa: E402
import platform  # noqa: E402
import subprocess  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402
import time  # noqa: E402
from collections.abc import Callable  # noqa: E402
from dataclasses import dataclass  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402

from pages import publish  # noqa: E402
from suite import assumptions, bars, environment, ours, page  # noqa: E402
from suite import speed as speeds  # noqa: E402
from suite.experiment import VARIANCE, Answers, Array, bound, record, routine  # noqa: E402

OUTPUT = Path(__file__).parent.parent / "docs" / "online.md"
SAMPLES, ROUTINE_SEEDS = 20_000, 20
Records = list[tuple[Array, Array]]


@dataclass(frozen=True)
class Method:
    """One row: what it is called, what it was told beyond orders and delay, how many seeds it can afford."""

    title: str
    told: str
    seeds: int
    work: Callable[[Records], Answers]


def ours_row(title: str, told: str, work: Callable[[Array, Array], object]) -> Method:
    return Method(title, told, 100, lambda records: ours.answers(work, records))


def rival_row(title: str, told: str, seeds: int, name: str) -> Method:
    return Method(title, told, seeds, lambda records: environment.answers(name, records))


def methods() -> list[Method]:
    """All rows, online first."""
    online = [ours_row("`RecursiveIV` (the paper)", "offset 0, sides of 0", ours.online(ours.recursive_iv))]
    if ours.HAS_ML:
        online.append(ours_row("`RecursiveML`", "nothing", ours.online(ours.recursive_ml)))
    start = "offset 0, white noise, start"
    return [
        *online,
        rival_row("padasip RLS, key-term (eq 23)", "offset 0, sides of 0", 20, "padasip key-term"),
        rival_row("padasip RLS, hinges", "offset 0, range of u", 20, "padasip hinges"),
        rival_row("filterpy unscented filter", f"{start}, noise variance", 8, "filterpy"),
        ours_row("batch `identify`", "nothing", ours.batch),
        rival_row("`scipy.optimize.least_squares`", start, 100, "least_squares"),
        rival_row("jax-sysid, L-BFGS", start, 20, "jax-sysid"),
    ]


def accuracy_row(method: Method, found: Answers, daily: Answers, limit: Array, yardstick: float) -> str:
    """One line of the table."""
    fits, step = found.fits(), float(np.median(found.seconds)) / SAMPLES
    cells = [
        method.title,
        method.told,
        f"{found.converged.sum()}/{len(found.zone)}",
        " / ".join(f"{value:.2f}" for value in found.rmse / limit),
        f"{np.median(fits):.2f} ({fits.min():.2f})",
        f"{daily.converged.sum()}/{len(daily.zone)}",
        f"{100 * daily.typical:.1f} %",
        duration(step),
        f"{step / yardstick:.3g}",
    ]
    return "| " + " | ".join(cells) + " |"


def duration(seconds: float) -> str:
    return f"{1e9 * seconds:.0f} ns" if seconds < 1e-6 else f"{1e6 * seconds:.1f} us"


def accuracy(share: float) -> tuple[str, dict[str, object]]:
    """Rows of the table, and the figures that the text beneath it quotes."""
    records = [record(SAMPLES, seed) for seed in range(round(100 * share))]
    days = [routine(seed) for seed in range(max(round(ROUTINE_SEEDS * share), 2))]
    commands = [u for u, _ in records]
    limit, free = bound(commands, "zero"), bound(commands, "free")
    yardstick = environment.yardstick(records[:3])
    lines = []
    for method in methods():
        found, daily = method.work(records[: max(round(method.seeds * share), 2)]), method.work(days)
        lines.append(accuracy_row(method, found, daily, limit, yardstick))
        print(lines[-1], flush=True)
    wider = " / ".join(f"{value:.2f}" for value in free / limit)
    at = " / ".join(f"{value:.5f}" for value in limit)
    return "\n".join(lines), {"limit": at, "wider": wider, "yardstick": yardstick}


def speed_rows(yardstick: float) -> tuple[str, float]:
    """Lines of the speed table, and the rate of a plain multiply-add loop."""
    peak, lines = speeds.peak_rate(), []
    for name, make in {**ours.ONLINE, **ours.TRACKING}.items():
        found = speeds.speed(make)
        rate = found.operations / found.run
        cells = [
            f"`{name}`",
            f"{1e9 * found.run:.0f} ns",
            f"{yardstick / found.run:.0f}",
            f"{1e6 * found.update:.2f} us",
            f"{found.operations:.0f}",
            f"{1e-9 * rate:.2f}",
            f"{100 * rate / peak:.0f} %",
        ]
        lines.append("| " + " | ".join(cells) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines), peak


def many_rows() -> str:
    """Lines of the table of many loops; empty while there is no ``run_many``."""
    try:
        from lostmotion.identify.recursive.many import run_many  # noqa: PLC0415
    except ImportError:
        return ""
    bare = speeds.two_threads()
    cells = ["plain sums, no shared memory", f"{bare[1]:.2f} s", "", f"{bare[2]:.2f} s", f"{bare[1] / bare[2]:.2f}"]
    lines = ["| " + " | ".join(cells) + " |"]
    print(lines[0], flush=True)
    for name, make in ours.ONLINE.items():
        loops = speeds.LOOPS if name == "RecursiveIV" else speeds.FEWER_LOOPS
        seconds = speeds.many(make, run_many, loops)
        step = 1e9 * seconds[1] / (loops * speeds.LOOP_SAMPLES)
        title = f"`{name}`" if loops == speeds.LOOPS else f"`{name}`, {loops} loops"
        cells = (title, f"{seconds[1]:.2f} s", f"{step:.0f} ns", f"{seconds[2]:.2f} s")
        lines.append("| " + " | ".join([*cells, f"{seconds[1] / seconds[2]:.2f}"]) + " |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def bar_section(share: float) -> str:
    """RecursiveML's bars and false events; empty while there is no RecursiveML."""
    if not ours.HAS_ML:
        return ""
    lines = []
    for samples in bars.LENGTHS:
        bar = bars.measure(ours.recursive_ml, samples, max(round(100 * share), 2))
        groups = (bar.rmse / bar.free, bar.rmse / bar.zero)
        ratios = [" / ".join(f"{value:.2f}" for value in group) for group in groups]
        cover = " / ".join(f"{100 * value:.0f}" for value in bar.coverage)
        lines.append(f"| {samples:,} | {bar.converged}/{bar.seeds} | {ratios[0]} | {ratios[1]} | {cover} |")
        print(lines[-1], flush=True)
    daily = max(round(60 * share), 2)
    short = bars.false_events(ours.recursive_ml, daily)
    long = bars.false_events(lambda: ours.recursive_ml(start_samples=2000), daily)
    print(f"false events: {short}; from 2,000 samples: {long}")
    seeds = max(round(ROUTINE_SEEDS * share), 2)
    wrong = page.ASSUMPTIONS.format(rows=assumptions.rows(seeds), seeds=seeds)
    return page.BARS.format(rows="\n".join(lines), short=short, long=long) + wrong


def command_seconds() -> float:
    """Seconds of `lostmotion online` on a CSV of 10^6 rows, start of the interpreter included."""
    u, y = record(speeds.LONG, seed=1)
    lostmotion = Path(sys.executable).parent / "lostmotion"
    with tempfile.TemporaryDirectory() as folder:
        log, state = Path(folder) / "log.csv", Path(folder) / "log.state"
        rows = (
            f"{k / 10:.1f},{command:.4f},{output:.4f}\n" for k, (command, output) in enumerate(zip(u, y, strict=True))
        )
        with log.open("w", encoding="utf-8") as file:
            file.write("time,OP,PV\n")
            file.writelines(rows)
        arguments = [lostmotion, "online", log, "--orders", "3,2,3", "--state", state, "--no-follow"]
        begin = time.perf_counter()
        subprocess.run([str(argument) for argument in arguments], check=True, stdout=subprocess.DEVNULL)
        return time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the seeds; writes nothing")
    share = 0.1 if parser.parse_args().quick else 1.0
    begin = time.perf_counter()
    environment.python()
    rows, figures = accuracy(share)
    speed, peak = speed_rows(figures["yardstick"])
    many, bar = many_rows(), bar_section(share)
    command = command_seconds()
    print(f"lostmotion online: {command:.1f} s")
    minutes = (time.perf_counter() - begin) / 60
    print(f"{minutes:.1f} minutes")
    if share < 1.0:
        return
    text = page.PAGE.format(
        rows=rows, speed=speed, variance=VARIANCE, peak=1e-9 * peak, minutes=minutes,
        limit=figures["limit"], wider=figures["wider"], yardstick=1e6 * figures["yardstick"],
        command=command, bar=bar, many=page.MANY.format(rows=many) if many else "",
        machine=f"Python {platform.python_version()}, NumPy {np.__version__}",
    )  # fmt: skip
    publish(OUTPUT, text)


if __name__ == "__main__":
    main()
