"""`lostmotion online` killed two hundred times on one growing record: no line is lost, changed or torn.

Run: ``PYTHONPATH=.:benchmarks .venv/bin/python benchmarks/hostile_online.py`` (some minutes; ``--seconds`` ends it
early); prints a table; exit code 1 where something in capitals came out. ``--clock-steps 20`` is another attack: so
many records, in each of which the clock of the control system is set forward and back, by seconds to days.

The record grows by pieces that end anywhere. `online` follows it with a state file, with masks (mode, limits of OP, a
frozen transmitter), and is killed: every other time just before a call that writes its state, another each time, and
else at any moment. What all starts have said, each line once, is compared byte for byte with what one start says that
nobody disturbs.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import lostmotion as lm
from hostile_log import Log
from hostile_tally import HEAD, told
from lostmotion.cli import main as command
from lostmotion.cli import online as _  # noqa: F401  loaded before the forks
from lostmotion.files.grid import Rows
from lostmotion.online import service
from tests.support.killed import begun, ended
from tests.support.killed import threads_of_polars as threads

KILLS, KILLS_EACH = 200, 3  # of one record; of each with steps of its clock
ROWS_EACH = 60  # that come between two kills
LOOKS = 0.02  # s between looks at the file, instead of 0.5: more happens between two kills
LONGEST = 0.5  # s until a start is killed at the latest
CALLS = 90  # that the start and two saves of the state make
OPTIONS = (
    "--orders", "1,0,1", "--noise", "white", "--start-samples", "300", "--report-every", "20", "--trend-every", "200",
    "--forgetting", "0.9995", "--op-limits", "-5", "5", "--frozen", "12", "--mode", "Mode", "--width-limit", "2.2",
)  # fmt: skip


def record(rows: int, stamps: np.ndarray | None = None) -> bytes:
    """Rows with stretches in manual, at a limit of OP, with a transmitter that stands, and with bad cells."""
    random = np.random.default_rng(1)
    u = np.round(lm.signals.prs(rows, -5.5, 5.5, hold=8, seed=1), 4)
    u = np.clip(u, -5.0, 5.0)
    x = np.where(u > 1, u - 1, np.where(u < -1, u + 1, 0.0))
    y = lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + 0.05 * random.normal(size=rows)
    lines = ["t_s,OP,PV,Mode"]
    stamps = 2 * np.arange(rows) + 7200 * (np.arange(rows) > rows // 2) if stamps is None else stamps
    for k in range(rows):
        pv = y[k - k % 700] if k % 700 < 30 else y[k]
        mode = "MAN" if k % 500 > 480 else "AUT"
        lines.append(f"{stamps[k]},{u[k]:.4f},{'Bad' if k % 997 == 500 else f'{pv:.4f}'},{mode}")
    return ("\n".join(lines) + "\n").encode()


class Watch:
    """Starts of the command on one file and one state, each with a file of its own for what it says."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.starts = folder, 0

    @property
    def said(self) -> Path:
        """What the last start has said."""
        return self.folder / f"said{self.starts:04d}"

    def start(self, *words: str, call: int = 0) -> int:
        """Process that has begun."""
        self.starts += 1
        asked = ["online", str(self.folder / "a.csv"), *OPTIONS, "--state", str(self.folder / "state"), *words]

        def work() -> None:
            service.POLL = LOOKS
            command(asked)

        with self.said.open("wb") as out, (self.folder / "errors").open("ab") as error:
            process: int = begun(work, call, out.fileno(), error.fileno())
        return process

    def errors(self) -> str:
        """What all starts have said on standard error."""
        return (self.folder / "errors").read_text()

    def wait(self) -> None:
        """Until the last start has said something, or 20 s."""
        until = time.monotonic() + 20.0
        while not self.said.stat().st_size and time.monotonic() < until:
            time.sleep(0.01)

    def lines(self) -> tuple[list[bytes], int]:
        """Whole lines of all starts in order, and how many pieces of lines a kill has left."""
        whole: list[bytes] = []
        pieces = 0
        for number in range(1, self.starts + 1):
            data = (self.folder / f"said{number:04d}").read_bytes()
            *lines, rest = data.split(b"\n")
            whole += lines
            pieces += bool(rest)
        return whole, pieces


def key(line: bytes) -> tuple[object, ...]:
    """What makes a line known again."""
    message = json.loads(line)
    return message["kind"], message.get("sample"), message.get("line"), message.get("name")


def once(lines: list[bytes], tally: Counter[str]) -> list[bytes]:
    """Each line once, in the order of its first time; what comes again must be the same."""
    found: dict[tuple[object, ...], bytes] = {}
    for line in lines:
        name = key(line)
        if name[0] == "start":
            continue
        if found.setdefault(name, line) != line:
            tally[f"CHANGED {name}"] += 1
        tally["lines said"] += 1
    return list(found.values())


def clock_steps(rows: int, random: np.random.Generator) -> np.ndarray:
    """Stamps of a clock that is set: forward or back, by a fraction of a sample to days, some three times."""
    stamps = 2.0 * np.arange(rows)
    for _step in range(random.integers(1, 4)):
        step = random.choice([0.5, 1, 2, 3, 10, 60, 3600, 86400, 1e7]) * random.choice([-1, 1])
        stamps[random.integers(5, rows) :] += step
    return stamps


def attack(data: bytes, kills: int, random: np.random.Generator, folder: Path, seconds: float) -> Counter[str]:
    """Kill, start, kill .., for so many seconds."""
    tally: Counter[str] = Counter()
    (folder / "whole").mkdir()
    (folder / "whole" / "a.csv").write_bytes(data)
    alone = Watch(folder / "whole")
    begun_at, code = time.monotonic(), ended(alone.start("--no-follow"))
    refused = alone.errors()
    tally[f"ALONE {code} {refused!r}"] = code not in (0, 1) or bool(refused and not one_line(refused))
    expected = once(alone.lines()[0], Counter())
    watch = Watch(folder)
    ends = np.sort(random.choice(len(data), 3 * kills, replace=False))
    with (folder / "a.csv").open("ab", buffering=0) as growing:
        growing.write(data[:400])
        written = 400
        for kill in range(kills):
            if time.monotonic() - begun_at > seconds:
                break
            call = 0 if kill % 2 else 1 + int(random.integers(CALLS))
            process = watch.start(call=call)
            if kill % 8 != 7:  # one of eight before it has begun
                watch.wait()
            until = time.monotonic() + (float(random.uniform(0.0, LONGEST)) if kill % 2 else 20 * LONGEST)
            for stop in ends[3 * kill : 3 * kill + 3]:
                time.sleep(float(random.uniform(0.0, 0.05)))
                growing.write(data[written : max(stop, written)])
                written = max(int(stop), written)
            tally += _killed(process, until, bool(refused))
        growing.write(data[written:])
    said = watch.errors()
    if said and not (one_line(said.replace(refused, "", said.count(refused) - 1)) and refused):
        tally[f"SAID ON STANDARD ERROR {said[:200]!r}"] = 1
    (watch.folder / "errors").write_bytes(b"")
    last = ended(watch.start("--no-follow"))
    quiet = not any(key(line)[0] == "event" for line in watch.said.read_bytes().split(b"\n")[:-1])
    tally[f"ENDS OTHERWISE {last} {code}"] = last != code and not (quiet and (last, code) == (0, 1))  # told before
    tally[f"OTHER WORDS {watch.errors()!r} {refused!r}"] = watch.errors() != refused
    tally["refused in one line, as by one start" if refused else "read to the end, as by one start"] = 1
    return tally + _compared(watch, expected)


def one_line(text: str) -> bool:
    """Whether it is what a command says that refuses a file."""
    return text.startswith("error: expected") and text.count("\n") == 1


def _killed(process: int, until: float, refused: bool) -> Counter[str]:
    """Wait for the end by its own call, and end it at the latest then."""
    while time.monotonic() < until:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            code = os.waitstatus_to_exitcode(status)
            expected = "ended by what is refused" if refused and code == 1 else f"ENDED {code}"
            return Counter({"killed at a call" if code == -signal.SIGKILL else expected: 1})
        time.sleep(0.005)
    os.kill(process, signal.SIGKILL)
    ended(process)
    return Counter({"killed at a moment": 1})


def _compared(watch: Watch, expected: list[bytes]) -> Counter[str]:
    tally: Counter[str] = Counter()
    lines, pieces = watch.lines()
    found = once(lines, tally)
    tally["lines that a kill cut, and that came again whole"] = pieces
    tally["lines of the one start"] = len(expected)
    tally["the same lines in the same order, byte for byte"] = int(found == expected)
    tally["OTHER LINES"] = int(found != expected)
    tally[f"lost {sorted(map(key, set(expected) - set(found)), key=str)[:5]}".upper()] = len({*expected} - {*found})
    tally["starts that went on from the state"] = sum(b"Goes on after" in line for line in lines)
    left = sorted(path.name for path in watch.folder.iterdir() if path.name.startswith(".lostmotion"))
    tally[f"LEFT OVER {left}"] = len(left)
    return +tally


def warm() -> None:
    """Compile the kernels once, for all processes that are forked from this one."""
    text = [line.split(",") for line in record(800).decode().splitlines()[1:]]
    op, pv = (np.array([float(row[k]) if row[k] != "Bad" else np.nan for row in text]) for k in (1, 2))
    monitor = lm.online.OnlineMonitor(lm.RecursiveML(1, 0, 1, dt=2.0, start_samples=300), dt=2.0, report_every=20)
    monitor.take(Rows(2.0 * np.arange(800), op, pv))
    lm.online.OnlineMonitor.from_bytes(monitor.to_bytes())
    assert not threads()


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--kills", type=int, default=KILLS)
    options.add_argument("--seconds", type=float, default=1e9, help="after which no more are begun")
    options.add_argument("--clock-steps", type=int, default=0, help="records with them, instead of kills of one")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--log", type=Path, help="keep what was tried")
    given = options.parse_args()
    warnings.simplefilter("error")  # in all processes that are forked from this one
    warm()
    random = np.random.default_rng(given.seed)
    print(HEAD)
    if given.clock_steps:
        return int(told("clock steps of online", stepped(given.clock_steps, random), Log(given.log)))
    with tempfile.TemporaryDirectory() as place:
        data = record((given.kills + 1) * ROWS_EACH)
        tally = attack(data, given.kills, random, Path(place), given.seconds)
    return int(told("kills of online", [tally], Log(given.log)))


def stepped(count: int, random: np.random.Generator) -> Iterator[Counter[str]]:
    """Records with steps of their clock, each killed a few times."""
    for _record in range(count):
        rows = int(random.integers(100, 900))
        with tempfile.TemporaryDirectory() as place:
            data = record(rows, clock_steps(rows, random))
            yield Counter({"records": 1}) + attack(data, KILLS_EACH, random, Path(place), np.inf)


if __name__ == "__main__":
    sys.exit(main())
