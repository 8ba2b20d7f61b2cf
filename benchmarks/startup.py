"""CPU time of starting: the package and the commands against importing NumPy, scipy.signal and Numba, in one run.

Run: ``.venv/bin/python benchmarks/startup.py`` (about 1 minute); writes docs/startup.md.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from lostmotion.files import write_columns
from pages import publish

REPEATS = 5
ROWS = 2_000
BAR = 0.25
OUTPUT = Path(__file__).parent.parent / "docs" / "startup.md"
BASE = ("-c", "import numpy, scipy.signal, numba")
BARRED = {
    "`import lostmotion`": ("-c", "import lostmotion"),
    "`lostmotion --version`": ("-m", "lostmotion", "--version"),
    "`lostmotion --help`": ("-m", "lostmotion", "--help"),
}
SHOWN = {
    "`lostmotion check --help`": ("-m", "lostmotion", "check", "--help"),
    "`lostmotion identify --help`": ("-m", "lostmotion", "identify", "--help"),
    "`lostmotion design --help`": ("-m", "lostmotion", "design", "--help"),
}


def cpu_seconds(words: tuple[str, ...]) -> float:
    """User and system time of a fresh interpreter."""
    process = subprocess.Popen([sys.executable, *words], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, words
    return used.ru_utime + used.ru_stime


def best(words: tuple[str, ...]) -> float:
    """Least of several runs, after one that fills the caches of the disk."""
    cpu_seconds(words)
    return min(cpu_seconds(words) for _ in range(REPEATS))


def record(folder: str) -> Path:
    """A loop that swings, in 2,000 rows."""
    time = np.arange(float(ROWS))
    op = 50.0 + 5.0 * np.sin(time / 40.0)
    table = {"time_s": time, "SP": np.full(ROWS, 50.0), "PV": 1.1 * op + 0.01 * np.cos(time), "OP": op}
    return write_columns(Path(folder) / "FIC-101.csv", table)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        check = {f"`lostmotion check FILE`, {ROWS:,} rows": ("-m", "lostmotion", "check", str(record(folder)))}
        base = best(BASE)
        seconds = {name: best(words) for name, words in (BARRED | SHOWN | check).items()}
    lines = [
        "# Start-up",
        "",
        f"Made by `.venv/bin/python benchmarks/startup.py`: CPU time (user and system) of a fresh interpreter, best of "
        f"{REPEATS}, all in",
        "one run. The times are of the machine of that run; the ratio is what carries over. Bar: the three after the",
        f"first line at most {BAR} of it.",
        "",
        "| what | CPU time | share of the first line |",
        "|---|---|---|",
        f'| `python -c "{BASE[1]}"` | {1e3 * base:.0f} ms | 1.00 |',
        *(f"| {name} | {1e3 * used:.0f} ms | {used / base:.2f} |" for name, used in seconds.items()),
        "",
        "`import lostmotion` reads the list of its names (`__init__.pyi`) and no more; each name is loaded when it is",
        "first used, each command when it is called, kernels are compiled or taken from the cache when they first run.",
        "`EAGER_IMPORT=1` in the environment loads everything at once, to find an import that fails.",
        "",
    ]
    publish(OUTPUT, "\n".join(lines))
    print("\n".join(lines))
    for name in BARRED:
        assert seconds[name] <= BAR * base, (name, seconds[name] / base)


if __name__ == "__main__":
    main()
