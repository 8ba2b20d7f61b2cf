"""A packed text of 2.6 million rows with four loops: processor time and memory of each command on one of them.

python benchmarks/long_file.py --folder /tmp/long --out long-file.md

Seconds or dates as times. Each command runs in a process of its own, as it is typed; memory is the most it held.
"""

from __future__ import annotations

import argparse
import gzip
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import polars as pl

from lostmotion.arrays import FloatArray

ROWS = 2_600_000
LOOPS = 4
BLOCK = 100_000  # rows written at a time
KIB = 1024 / 1e9  # GB
COMMANDS = ("check", "identify", "diagnose")


def loop(seed: int, rows: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """OP, PV and SP of a flow loop with a dead zone under PI control; shape (rows,) each."""
    rng = np.random.default_rng([seed, 26])
    noise = (0.1 * rng.normal(size=rows)).tolist()
    wanted = np.repeat(rng.uniform(45.0, 55.0, size=rows // 300 + 1), 300)[:rows].tolist()
    op, pv = [0.0] * rows, [0.0] * rows
    x = integral = 50.0
    for k in range(rows):
        pv[k] = x + noise[k]
        error = wanted[k] - pv[k]
        integral += 0.03 * error
        op[k] = min(max(integral + 0.3 * error, 0.0), 100.0)
        moved = op[k] - 50.0
        through = 50.0 + (moved - min(max(moved, -0.5), 0.5))
        x += 0.1 * (through - x)
    return np.array(op), np.array(pv), np.array(wanted)


def write(path: Path, rows: int, dated: bool) -> None:
    """Write the file, a block at a time."""
    columns: dict[str, FloatArray] = {}
    for number in range(LOOPS):
        for name, values in zip(("OP", "PV", "SP"), loop(number, rows), strict=True):
            columns[f"FIC{101 + number}.{name}"] = np.round(values, 3)
    begun = np.datetime64("2026-01-01T00:00:00", "us")
    with gzip.open(path, "wb", compresslevel=1) as file:
        for first in range(0, rows, BLOCK):
            seconds = np.arange(first, min(first + BLOCK, rows))
            stamp = begun + seconds.astype("timedelta64[s]") if dated else seconds
            part = pl.DataFrame({"Time" if dated else "t_s": stamp, **{n: v[seconds] for n, v in columns.items()}})
            part.write_csv(file, include_header=first == 0, datetime_format="%Y-%m-%d %H:%M:%S")


def measured(command: str, path: Path, folder: Path) -> tuple[float, float, str]:
    """Processor time in s, memory in GB and the last line that a command printed."""
    typed = [sys.executable, "-m", "lostmotion", command, str(path), "--loop", "FIC102"]
    typed += ["--out", str(folder / f"{command}.json"), "--force"] if command != "check" else []
    with (folder / f"{command}.txt").open("wb") as said:
        process = subprocess.Popen(typed, stdout=said, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    lines = (folder / f"{command}.txt").read_text(encoding="utf-8").strip().splitlines()
    told = "" if process.returncode == 0 else f" (ended with {process.returncode})"
    return used.ru_utime + used.ru_stime, used.ru_maxrss * KIB, (lines[-1] if lines else "") + told


def table(folder: Path, rows: int, commands: list[str]) -> Iterator[str]:
    """Markdown, a line as soon as it is known."""
    yield "| times | packed, MB | command | s of a processor | GB | said at last |"
    yield "|---|---:|---|---:|---:|---|"
    for dated in (False, True):
        path = folder / f"{'dates' if dated else 'seconds'}-{rows}.csv.gz"
        if not path.exists():
            write(path, rows, dated)
        size = path.stat().st_size / 1e6
        for command in commands:
            seconds, memory, said = measured(command, path, folder)
            kind = "dates" if dated else "seconds"
            yield f"| {kind} | {size:.0f} | {command} | {seconds:.1f} | {memory:.2f} | {said[:90]} |"


def main() -> None:
    """Print the table, and write it where that is wanted."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", type=int, default=ROWS)
    parser.add_argument("--folder", type=Path, required=True, help="where the files are kept: 150 MB")
    parser.add_argument("--commands", nargs="*", default=list(COMMANDS), choices=COMMANDS)
    parser.add_argument("--out", type=Path)
    asked = parser.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    begun, lines = time.monotonic(), []
    for line in table(asked.folder, asked.rows, asked.commands):
        print(line, flush=True)
        lines.append(line)
    print(f"\n{time.monotonic() - begun:.0f} s in all")
    if asked.out is not None:
        asked.out.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
