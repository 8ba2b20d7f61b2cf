"""Attack on the readers: mutated files of every format, and files beside records, in forked workers.

Run: ``PYTHONPATH=.:benchmarks .venv/bin/python benchmarks/hostile_readers.py`` (an hour or two); ``--count 200`` is a
quick look, ``--log FILE`` keeps what was tried and goes on there. Prints a table of outcomes by format; exit code 1
where anything but a record or a refusal in one line came out. A file that did harm is kept under ``--keep``. File
number k of a format and seed is always the same.
"""

from __future__ import annotations

import argparse
import os
import re
import selectors
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import lostmotion as lm
from hostile_log import Log, source
from lostmotion.files.limits import MOST_GIB, MOST_SECONDS
from lostmotion.files.reader_process import KEPT
from tests.support import use_of_files
from tests.support.hostile_files import APART, FORMATS, FRAMES, bases
from tests.support.hostile_plant import PLANT
from tests.support.killed import threads_of_polars

ATTACK, BESIDE = "readers", "files beside records"
COUNT = 20_000
PATIENCE, START = 60.0, 300.0  # seconds for one file, and for the first of a worker, which loads what it needs
MEMORY = 1 << 29  # bytes of address space of a worker, beyond what Python and its packages take: threads reserve some
LESS = {MOST_GIB: "1.2", MOST_SECONDS: "5"}  # of a reader in its process; by itself 2 and more, and 60
AT_ONCE = 2000  # files of one worker: memory that is not given back would end it
TOLD = 500  # files between two lines of the log
ENDED = "ended the process of its reader"
EVERY = (*FORMATS, FRAMES, *PLANT)
DIED = ("SIGNAL", "HANG", "MEMORY")


class Worker:
    """A fork of this process that reads the files whose numbers it is told; made again where it dies, and now and then.

    Parameters
    ----------
    kind : str
        Format.
    seed : int
    path : Path
        Where the file is put that is tried.
    here : bool
        Readers that have a process of their own do without it, which is a hundred times faster.
    """

    def __init__(self, kind: str, seed: int, path: Path, here: bool) -> None:
        self.given = (kind, seed, path, here, MEMORY)
        self.process = self.tried = 0

    def outcome(self, number: int) -> str:
        """What came of a file."""
        if not self.process or self.tried >= AT_ONCE:
            self.end()
            self._begin()
        patience = PATIENCE if self.tried else START
        self.tried += 1
        os.write(self.asking, b"%d\n" % number)
        with selectors.DefaultSelector() as waits:
            waits.register(self.answers, selectors.EVENT_READ)
            told = b""
            while not told.endswith(b"\n"):
                if not waits.select(patience):
                    self.end()
                    return "HANG"
                piece = os.read(self.answers, 1 << 16)
                if not piece:
                    code = self.end()
                    if not code:
                        raise RuntimeError(f"expected outcomes of {self.given[0]}, got a worker that ended by itself")
                    return f"SIGNAL {-code}"
                told += piece
        return told.decode("utf-8", "replace").rstrip("\n")

    def _begin(self) -> None:
        asked, self.asking = os.pipe()
        self.answers, said = os.pipe()
        self.process, self.tried = os.fork(), 0
        if not self.process:
            try:
                for mine in (self.asking, self.answers):
                    os.close(mine)
                use_of_files.serve(asked, said, *self.given)
            except BaseException:  # noqa: BLE001  told, and the parent is told by the end
                traceback.print_exc(file=sys.__stdout__)
            finally:  # nothing may go on in two processes
                os._exit(0)
        for other in (asked, said):
            os.close(other)

    def end(self) -> int:
        """Its exit code; the next file has another one."""
        if not self.process:
            return 0
        for pipe in (self.asking, self.answers):
            os.close(pipe)
        os.kill(self.process, signal.SIGKILL)  # the other worker may hold its pipes; of one that has died, no change
        code = os.waitstatus_to_exitcode(os.waitpid(self.process, 0)[1])
        self.process = 0
        return code

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()


def attack_of(kind: str) -> str:
    """Name in the log, by which it is known what of the package was attacked."""
    return BESIDE if kind in PLANT else ATTACK


def attacked(kind: str, numbers: range, seed: int, keep: Path | None, log: Log) -> Counter[str]:
    """Outcomes of files of a format; Ctrl-C and SIGTERM end it, and what has been tried is told."""
    whole: Counter[str] = Counter()
    part: Counter[str] = Counter()
    begin, since, number = numbers.start, time.monotonic(), numbers.start - 1

    def told() -> None:
        nonlocal begin, since, part
        if number >= begin:
            log.add(attack_of(kind), kind, part, time.monotonic() - since, seed=seed, begin=begin, stop=number + 1)
        whole.update(part)
        begin, since, part = number + 1, time.monotonic(), Counter()

    with tempfile.TemporaryDirectory() as place, suppress(KeyboardInterrupt):
        path = Path(place) / "FIC-101.dat"
        with Worker(kind, seed, path, here=True) as fast, Worker(kind, seed, path, here=False) as apart:
            for now in numbers:
                said = fast.outcome(now)
                died = kind in APART and said.startswith(DIED)
                if died:  # as it is for users: the reader in a process of its own
                    said = apart.outcome(now)
                part[_class_of(said)] += 1
                part[ENDED] += died
                number = now
                if _bad(said):
                    _kept(keep, path, kind, now, seed, said)
                if (now + 1) % TOLD == 0:
                    told()
    told()
    return whole


def _kept(keep: Path | None, path: Path, kind: str, number: int, seed: int, said: str) -> None:
    """The file that did harm, and what it did."""
    if keep is None:
        return
    keep.mkdir(parents=True, exist_ok=True)
    with (keep / "list.txt").open("a") as listed:
        listed.write(f"{kind}\t{seed}\t{number}\t{said}\n")
    if kind != FRAMES:
        shutil.copy(path, keep / f"{kind.replace(' ', '')}-{seed}-{number}")


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


@dataclass(frozen=True)
class Sorted:
    """Tally of a format by what the page tells."""

    tried: int
    read: int
    refused: int
    died: int
    worse: str


def sorted_out(tally: Counter[str]) -> Sorted:
    """Numbers of files by outcome; `worse`: all that is neither a record nor a refusal, "0" where there is none."""
    rest = Counter(tally)
    died = rest.pop(ENDED, 0)
    worse = sorted((said, times) for said, times in rest.items() if _bad(said))
    shown = "; ".join(f"{times} x {said}".replace("|", "/") for said, times in worse) or "0"
    return Sorted(rest.total(), rest["read"], rest["refused"], died, shown)


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--count", type=int, default=COUNT)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", choices=EVERY, action="append")
    options.add_argument("--keep", type=Path)
    options.add_argument("--log", type=Path, help="keep what was tried; go on behind what is there of this source")
    options.add_argument("--times", type=int, default=0, help="instead: so many sound files of a format")
    given = options.parse_args()
    if given.times:
        times(given.times)
        return 0
    os.environ.update(LESS | os.environ)
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    warnings.simplefilter("error")  # in all workers, which are forked from this one
    assert not threads_of_polars()
    log, bad = Log(given.log), False
    print("| format | files | read | refused in one line | ended the process of their reader | anything else | s |")
    print("|---|---|---|---|---|---|---|")
    for kind in given.only or EVERY:
        begun, before = 0, Counter[str]()
        for old in log.entries():
            same = (old.attack, old.source) == (attack_of(kind), source(attack_of(kind)))
            if same and (old.part, old.more.get("seed")) == (kind, given.seed):
                begun, before = max(begun, old.more["stop"]), before + old.tally
        since = time.monotonic()
        found = attacked(kind, range(begun, given.count), given.seed, given.keep, log)
        one = sorted_out(before + found)
        bad |= one.worse != "0"
        cells = (kind, one.tried, one.read, one.refused, one.died, one.worse, round(time.monotonic() - since))
        print(f"| {' | '.join(map(str, cells))} |", flush=True)
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
