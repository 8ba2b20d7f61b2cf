"""CPU time of starting: the package and the commands against importing NumPy, scipy.signal and Numba, in one run.

And of the first `identify` and `diagnose` after an installation, which compile; with the seconds of each kernel.

Run: ``.venv/bin/python benchmarks/startup.py`` (about 4 minutes); writes docs/startup.md.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import lostmotion as lm
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


COLD = {"identify": 50.0, "diagnose": 75.0}  # s of processor time: what a first one may take
LARGEST = 12  # kernels in the table
# The command in a process that listens to Numba: seconds of each function without those that it compiles on its way.
LISTENER = """
import json, sys, time
from numba.core import event
from lostmotion.cli import main

class Listener(event.Listener):
    open, own = [], {}
    def on_start(self, event):
        self.open.append([time.process_time(), 0.0])
    def on_end(self, event):
        began, within = self.open.pop()
        spent, function = time.process_time() - began, event.data["dispatcher"].py_func
        name = f"{function.__module__}.{function.__name__}".removeprefix("lostmotion.kernels.")
        number, seconds = self.own.get(name, (0, 0.0))
        self.own[name] = (number + 1, seconds + spent - within)
        if self.open:
            self.open[-1][1] += spent

event.register("numba:compile", Listener())
try:
    main(sys.argv[2:])
finally:
    with open(sys.argv[1], "w") as stream:
        json.dump([time.process_time(), Listener.own], stream)
"""


def first_of(command: str, record: Path, folder: Path) -> tuple[float, dict[str, tuple[int, float]]]:
    """Processor time of a first command with an empty cache, and number and seconds of what it compiled."""
    told, script = folder / f"{command}.json", folder / "listen.py"
    script.write_text(LISTENER, encoding="utf-8")
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / f"cache-{command}")}
    words = [sys.executable, str(script), str(told), command, str(record)]
    subprocess.run(words, env=environment, stdout=subprocess.DEVNULL, check=False)
    seconds, own = json.loads(told.read_text(encoding="utf-8"))
    return seconds, own


def cold_lines(folder: Path) -> list[str]:
    """Tables of the first commands."""
    sample = lm.datasets.path("FIC-101")
    lines = [
        "## The first command after an installation",
        "",
        "It compiles the kernels for this processor; `lostmotion warm-up` does so beforehand. With an empty cache, on",
        "the sample FIC-101:",
        "",
        "| first | processor time | bar | functions compiled | of these lostmotion's |",
        "|---|---|---|---|---|",
    ]
    tables = {command: first_of(command, sample, folder) for command in COLD}
    for command, (seconds, own) in tables.items():
        number = sum(count for count, _ in own.values())
        ours = sum(count for name, (count, _) in own.items() if not name.startswith("numba"))
        lines.append(f"| `lostmotion {command}` | {seconds:.0f} s | {COLD[command]:.0f} s | {number} | {ours} |")
    own = tables["identify"][1]
    largest = sorted(own.items(), key=lambda item: -item[1][1])[:LARGEST]
    rest = sum(seconds for _, seconds in own.values()) - sum(seconds for _, (_, seconds) in largest)
    lines += ["", "Seconds of the largest kernels in `identify`:", "", "| kernel | compiled | s |", "|---|---|---|"]
    lines += [f"| `{name}` | {count} | {seconds:.1f} |" for name, (count, seconds) in largest]
    return [*lines, f"| all others | {sum(count for count, _ in own.values())} in all | {rest:.1f} |", ""]


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
        cold = cold_lines(Path(folder))
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
        *cold,
    ]
    publish(OUTPUT, "\n".join(lines))
    print("\n".join(lines))
    for name in BARRED:
        assert seconds[name] <= BAR * base, (name, seconds[name] / base)


if __name__ == "__main__":
    main()
