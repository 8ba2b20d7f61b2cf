"""Attack on the readers: mutated files of every format, in worker processes that are started again where one dies.

Run: ``PYTHONPATH=. .venv/bin/python benchmarks/hostile_readers.py`` (an hour or two); ``--count 200`` is a quick look.
Prints a table of outcomes by format; exit code 1 where anything but a record or a refusal in one line came out. A file
that did harm is kept under ``--keep``. File number k of a format and seed is always the same.
"""

from __future__ import annotations

import argparse
import os
import re
import selectors
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import lostmotion as lm
from lostmotion.files.reader_process import KEPT
from tests.hostile_files import APART, FORMATS, FRAMES, bases, mutant

COUNT = 20_000
PATIENCE, START = 60.0, 300.0  # seconds for one file, and for the start of a worker
MEMORY = 3 << 30  # bytes of address space of a worker, of which Python and its packages take 1.4
AT_ONCE = 2000  # files of one worker: memory that is not given back would end it
READY = -1  # said by a worker before its first file
ENDED = "ended the process of its reader"
DIED = ("SIGNAL", "HANG", "MEMORY")


def attacked(kind: str, count: int, seed: int, keep: Path | None, tally: Counter[str]) -> None:
    """Add the outcomes of files 0 .. count."""
    begin = 0
    while begin < count:
        last = begin - 1
        for number, first in _of_worker(kind, begin, min(count, begin + AT_ONCE), seed):
            last, said = number, first
            if kind in APART and first.startswith(DIED):  # as it is for users: the reader in a process of its own
                tally[ENDED] += 1
                ((_, said),) = _of_worker(kind, number, number + 1, seed, "apart")
            tally[_class_of(said)] += 1
            if _bad(said):
                _kept(keep, kind, number, seed, said)
        begin = last + 1


def _kept(keep: Path | None, kind: str, number: int, seed: int, said: str) -> None:
    """The file that did harm, and what it did."""
    if keep is None:
        return
    keep.mkdir(parents=True, exist_ok=True)
    with (keep / "list.txt").open("a") as listed:
        listed.write(f"{kind}\t{number}\t{said}\n")
    if kind != FRAMES:
        (keep / f"{kind.replace(' ', '')}-{seed}-{number}").write_bytes(mutant(kind, number, seed))


def _of_worker(kind: str, begin: int, stop: int, seed: int, *how: str) -> Iterator[tuple[int, str]]:
    """Number and outcome of each file that it came to; the last one says how it died, if it did."""
    words = [kind, str(begin), str(stop), str(seed), str(MEMORY), *how]
    command = [sys.executable, "-W", "error", "-m", "tests.use_of_files", *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as worker:
        known, ready = b"", False
        for piece in _pieces(worker):
            *lines, known = (known + piece).split(b"\n")
            for line in lines:
                number, _, said = line.decode("utf-8", "replace").partition(" ")
                ready = True
                if int(number) != READY:
                    yield int(number), said
        if not ready:
            raise RuntimeError(f"the worker does not start: {command}")
        if known:
            code = worker.wait()
            yield int(known.split(b" ")[0]), "HANG" if code == -9 else f"SIGNAL {-code}"


def _pieces(worker: subprocess.Popen[bytes]) -> Iterator[bytes]:
    """What it says; killed where it says nothing for longer than one file may take."""
    assert worker.stdout is not None
    patience = START
    with selectors.DefaultSelector() as waits:
        waits.register(worker.stdout, selectors.EVENT_READ)
        while waits.select(patience):
            piece = worker.stdout.read1(1 << 16)  # type: ignore[attr-defined]
            if not piece:
                return
            yield piece
            patience = PATIENCE
        worker.kill()


def _bad(said: str) -> bool:
    return bool(re.match("[A-Z]{4}", said)) or " STRAY " in said


def _class_of(said: str) -> str:
    """Outcome without what differs from file to file."""
    return re.sub(r"\d{2,}", "#", said)[:110] if _bad(said) else said


def times(count: int) -> None:
    """Print what a sound small file costs of each format that is read in another process, its start shared by all."""
    for kind in APART:
        with tempfile.TemporaryDirectory() as place:
            path = Path(place) / "a.dat"
            path.write_bytes(bases(kind)[0])
            before = os.times()
            for _ in range(count):
                lm.read_loops(path, dt=1.0 if kind == "mat 7.3" else None)
            KEPT.end()  # only what has ended is counted
            spent = sum(os.times()[:4]) - sum(before[:4])
        print(f"{kind}: {1e3 * spent / count:.0f} ms of processor time a file, {count} one after the other", flush=True)


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--count", type=int, default=COUNT)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", choices=(*FORMATS, FRAMES), action="append")
    options.add_argument("--keep", type=Path)
    options.add_argument("--times", type=int, default=0, help="instead: so many sound files of a format")
    given = options.parse_args()
    if given.times:
        times(given.times)
        return 0
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    bad = 0
    print("| format | files | read | refused in one line | ended the process of their reader | anything else | s |")
    print("|---|---|---|---|---|---|---|")
    for kind in given.only or (*FORMATS, FRAMES):
        begin = time.monotonic()
        tally: Counter[str] = Counter()
        with suppress(KeyboardInterrupt):  # what has been tried is told
            attacked(kind, given.count, given.seed, given.keep, tally)
        died = tally.pop(ENDED, 0)
        worse = {said: times for said, times in tally.items() if _bad(said)}
        bad += len(worse)
        took = time.monotonic() - begin
        shown = "; ".join(f"{times} x {said}" for said, times in sorted(worse.items())) or "0"
        cells = (kind, tally.total(), tally["read"], tally["refused"], died, shown, round(took))
        print(f"| {' | '.join(map(str, cells))} |", flush=True)
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
