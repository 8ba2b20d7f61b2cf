"""Attack on what lostmotion writes: killed at every call and at any moment, full and read-only disks, two at once.

Run: ``PYTHONPATH=.:benchmarks .venv/bin/python benchmarks/hostile_writers.py`` (some ten minutes); ``--only NAME`` is
one part. Prints a table; exit code 1 where something in capitals came out: a file that is neither the old one nor the
new one, something left over after the next write, or anything but one line about a failure.

- kills: every writer is killed just before a call that it makes, another each time, and, as often, at any moment; then
  the same is written again
- disks: every command that writes, on a file system of 64 KiB that is full, and on one that is read-only; it needs to
  be root to make them
- two at once: two exports into one folder, two figures of one name, two `online` with one state
- standard output: every command, with nobody who reads and on a full disk
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import matplotlib as mpl
import numpy as np
import polars as pl
from matplotlib.figure import Figure

import lostmotion as lm
from hostile_log import Log
from hostile_tally import HEAD, told
from lostmotion.cli.output import OutputOptions
from lostmotion.compensate import read_block
from lostmotion.export import export
from lostmotion.export.exported import Exported
from lostmotion.files import write_columns
from lostmotion.files.grid import Rows
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import Kept
from tests.support import commands_that_write as commands
from tests.support import state_of_online as online
from tests.support.exports import block
from tests.support.killed import forked, threads_of_polars

mpl.use("agg")
KILLS = 50  # of each writer
LONGEST = 0.05  # s after which a writer is killed at the latest
ROWS = 400
NEW = OutputOptions(force=True)
Tally = Counter[str]
Tries = Iterator[Tally]


@dataclass(frozen=True)
class Writes:
    """A way to write: `work` writes number k into a folder, `whole` says whether what is there is one of these."""

    work: Callable[[Path, int], None]
    whole: Callable[[Path], bool]


class Drawn:
    """A result with a figure."""

    def plot(self) -> Figure:
        """Draw a line."""
        figure = Figure(figsize=(3, 2))
        figure.subplots().plot([0, 1], [0, 1])
        return figure


def figure(ending: str) -> Writes:
    """A figure of any command."""

    def whole(folder: Path) -> bool:
        data = (folder / f"a.{ending}").read_bytes()
        if ending == "png":
            return mpl.image.imread(BytesIO(data)).size > 0
        if ending == "pdf":
            return data.startswith(b"%PDF") and data.rstrip().endswith(b"%%EOF")
        return ET.fromstring(data).tag.endswith("svg")  # noqa: S314  our own file

    return Writes(lambda folder, _: NEW.write_figure(folder / f"a.{ending}", Drawn()), whole)


def table(ending: str) -> Writes:
    """Columns, of one value each."""

    def work(folder: Path, number: int) -> None:
        write_columns(folder / f"a{ending}", {name: np.full(ROWS, float(number)) for name in ("OP", "PV")}, force=True)

    def whole(folder: Path) -> bool:
        path = folder / f"a{ending}"
        found = pl.read_parquet(path) if ending == ".parquet" else pl.read_csv(path)
        return found.shape == (ROWS, 2) and found["OP"].n_unique() == 1 and bool((found["OP"] == found["PV"]).all())

    return Writes(work, whole)


def of_json(write: Callable[[Path, Any], None]) -> Writes:
    """JSON: its first value stands at its end too."""

    def whole(folder: Path) -> bool:
        found = json.loads((folder / "a.json").read_text())
        return bool(found["first"] == found["last"])

    def work(folder: Path, number: int) -> None:
        write(folder / "a.json", {"first": number, "rows": [0.5] * ROWS, "last": number})

    return Writes(work, whole)


def blocks() -> Writes:
    """A block as it is saved, and read again by its schema."""
    kinds = [block("backlash"), block("dead zone")]
    return Writes(
        lambda folder, number: NEW.write_json(folder / "a.json", kinds[number % 2].to_dict()),
        lambda folder: read_block(folder / "a.json") in kinds,
    )


def code(replaced: bool) -> Writes:
    """An export into a new folder each time, or over the one before."""
    made = [export(block(kind), "st", name="FY_101", date="2026-01-31") for kind in ("backlash", "dead zone")]
    names = sorted(made[0].files)

    def work(folder: Path, number: int) -> None:
        made[number % 2].write(folder / ("old" if replaced else f"new{number}"), force=replaced)

    def whole(folder: Path) -> bool:
        return all(_of_one(place, made, names) for place in folder.glob("[!.]*"))

    return Writes(work, whole)


def _of_one(place: Path, made: list[Exported], names: list[str]) -> bool:
    """All files of one of the exports; over another, every file of one of them."""
    found = {path.name: path.read_text() for path in place.iterdir()}
    together = any(found == one.files for one in made)
    return together or (place.name == "old" and all(found[name] in [one.files[name] for one in made] for name in names))


def page() -> Writes:
    """The page of the paper and its numbers."""

    def work(folder: Path, number: int) -> None:
        NEW.write_text(folder / "a.html", f"<p>{number}</p>" * ROWS)

    return Writes(work, lambda folder: len(set((folder / "a.html").read_text().split("</p>")[:-1])) == 1)


def state() -> Writes:
    """The state of `online`, with its masks; other rows each time."""
    settings = {**online.MODEL, **online.WATCH}
    monitors = [_monitor(rows) for rows in (50, 80)]
    kept = [monitor.to_bytes() for monitor in monitors]
    with tempfile.TemporaryDirectory() as place:
        assert forked(lambda: commands.position(Path(place))) == 0
        position = json.loads((Path(place) / "position").read_text())

    class At:
        """A follower, as far as the state needs one."""

    at: Any = At()
    at.position = position

    def work(folder: Path, number: int) -> None:
        with Kept(folder / "state", settings) as place:
            place.save(at, monitors[number % 2])

    def whole(folder: Path) -> bool:
        with Kept(folder / "state", settings) as place:
            assert place.monitor is not None
            return place.monitor.to_bytes() in kept

    return Writes(work, whole)


def _monitor(rows: int) -> OnlineMonitor:
    monitor = OnlineMonitor(lm.RecursiveML(**online.MODEL, dt=2.0), dt=2.0, **online.WATCH)
    random = np.random.default_rng(0)
    monitor.take(Rows(2.0 * np.arange(rows), random.normal(0.0, 40.0, rows), np.repeat(random.normal(), rows)))
    return monitor


def writers() -> dict[str, Writes]:
    """All of them, by name."""
    return {
        **{f"figure {ending}": figure(ending) for ending in ("png", "pdf", "svg")},
        "JSON of a result": of_json(NEW.write_json),
        "JSON that grows": of_json(commands.keep),
        "block": blocks(),
        "CSV": table(".csv"),
        "Parquet": table(".parquet"),
        "page": page(),
        "code, new folder": code(replaced=False),
        "code, replaced": code(replaced=True),
        "state of online, with its masks": state(),
    }


def attack_kills(count: int, random: np.random.Generator) -> Tries:
    """Each writer, `count` times: half of them at a call, half at a moment."""
    made = writers()
    assert not threads_of_polars()
    calls = {name: _calls(writes) for name, writes in made.items()}
    for number in range(count):
        for name, writes in made.items():
            at_call = number % 2 == 0
            call = 1 + round(number / max(count - 1, 1) * (calls[name] - 1)) if at_call else 0
            yield _killed(name, writes, call, None if at_call else float(random.uniform(0.0, LONGEST)))


def _calls(writes: Writes) -> int:
    """Calls that the writer makes for one write over another, by killing at ever later ones."""
    low, high = 1, 2000
    while high - low > 1:
        middle = (low + high) // 2
        with tempfile.TemporaryDirectory() as place:
            forked(lambda: writes.work(Path(place), 0))
            survived = forked(lambda: writes.work(Path(place), 1), call=middle) == 0
        low, high = (low, middle) if survived else (middle, high)
    return low


def _killed(name: str, writes: Writes, call: int, seconds: float | None) -> Tally:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        assert forked(lambda: writes.work(folder, 0)) == 0

        def work() -> None:
            for number in range(1, 2 if call else 1_000_000):
                writes.work(folder, number)

        code = forked(work, call, seconds)
        if code != -9:
            return Tally({f"NOT KILLED {name} {call} {code}": 1})
        hidden = sum(path.name.startswith(".lostmotion") for path in folder.rglob("*"))
        # in processes of their own as well, so that the readers start no threads before the next fork
        torn = forked(lambda: sys.exit(0 if writes.whole(folder) else 1)) != 0
        for made in folder.glob("new*"):
            shutil.rmtree(made)
        again = forked(lambda: _next(writes, folder)) != 0
        left = [path.name for path in folder.rglob(".lostmotion*")]
    tally = Tally({f"{name}: killed": 1, f"{name}: a second name until the next write": int(hidden > 0)})
    tally[f"TORN {name}"] += torn
    tally[f"THE NEXT WRITE FAILED {name}"] += again
    tally[f"LEFT OVER {name} {left}"] += bool(left)
    return +tally


def _next(writes: Writes, folder: Path) -> None:
    writes.work(folder, 1)
    writes.work(folder, 2)
    sys.exit(0 if writes.whole(folder) else 1)


@contextmanager
def small_disk(size: str) -> Iterator[Path]:
    """A file system of its own.

    Raises
    ------
    OSError
        Only root can mount.
    """
    with tempfile.TemporaryDirectory() as place:
        if _mount("-t", "tmpfs", "-o", f"size={size}", "tmpfs", place):
            raise OSError("no mount")
        try:
            yield Path(place)
        finally:
            subprocess.run(["/bin/umount", "-l", place], check=False)


def _mount(*words: str) -> int:
    return subprocess.run(["/bin/mount", *words], capture_output=True, check=False).returncode


def attack_disks(_: int, random: np.random.Generator) -> Tries:
    """Every command that writes, in any order, where there is no room, and where nothing may be written."""
    with tempfile.TemporaryDirectory() as place:
        given = commands.prepare(Path(place))
        found = commands.writing(given)
        for name in random.permutation(list(found)):
            words = found[name]
            for disk in ("full", "read-only"):
                try:
                    with small_disk("64k") as folder:
                        done = _on_disk(name, words, disk, folder)
                except OSError as error:
                    done = Tally({f"NOT TRIED {error}": 1})
                yield done


def _on_disk(name: str, words: commands.Words, disk: str, folder: Path) -> Tally:
    """The command, once, on that disk; then once more with room."""
    old = folder / "old.txt"
    old.write_text("old")
    (folder / "filler").write_bytes(b"")
    if disk == "full":
        _fill(folder / "filler")
    else:
        assert not _mount("-o", "remount,ro", str(folder))
    before = commands.contents(folder)
    done = commands.run(words(folder))
    after = commands.contents(folder)
    tally = Tally({f"{disk}: {commands.outcome(done)}": 1})
    tally[f"CHANGED {name} {disk} {sorted(after.keys() ^ before.keys())}"] += after != before
    tally[f"WENT ON {name} {disk} {done.stdout[-100:]!r}"] += done.returncode == 0
    tally[f"NO RESULT {name}"] += disk == "full" and name not in commands.FILES_ONLY and not done.stdout
    if disk == "full":
        (folder / "filler").unlink()
        assert not _mount("-o", "remount,size=8m", str(folder))
    else:
        assert not _mount("-o", "remount,rw,size=8m", str(folder))
    again = commands.run(words(folder))
    tally[f"THE NEXT START FAILED {name} {disk} {again.stderr[-200:]!r}"] += "error" in again.stderr
    tally["the next start works"] += "error" not in again.stderr
    return +tally


def _fill(path: Path) -> None:
    with path.open("wb", buffering=0) as stream:
        try:
            while True:
                stream.write(bytes(4096))
        except OSError:
            return


def attack_pairs(count: int, _: np.random.Generator) -> Tries:
    """Two commands that write the same, begun together; without --force one is refused."""
    with tempfile.TemporaryDirectory() as place:
        given = commands.prepare(Path(place))
        for number in range(count):
            for name, pair in commands.pairs(given).items():
                with tempfile.TemporaryDirectory() as made:
                    yield _pair(name, pair, Path(made), number)


def _pair(name: str, pair: commands.Pair, folder: Path, number: int) -> Tally:
    running = [commands.Running(words(folder)) for words in pair.both]
    done = [one.ended() for one in running]
    said = sorted(commands.outcome(one) for one in done)
    tally = Tally({f"{name}: {' and '.join(said)}": 1})
    tally[f"NOT ONE OF BOTH {name} {number}"] += not pair.whole(folder)
    tally[f"BOTH {name}"] += pair.one_only and sum(commands.outcome(one) != "done" for one in done) != 1
    tally[f"LEFT OVER {name}"] += any(path.name.startswith(".lostmotion") for path in folder.rglob("*"))
    return +tally


def attack_output(_: int, random: np.random.Generator) -> Tries:
    """Every command that says something, to nobody, onto a full disk and into a pipe that is closed behind a line."""
    with tempfile.TemporaryDirectory() as place:
        given = commands.prepare(Path(place))
        found = commands.saying(given)
        for name in random.permutation(list(found)):
            words = found[name]
            with tempfile.TemporaryDirectory() as made:
                whole = commands.run(words(Path(made)))
            for where in commands.OUTPUTS:
                with tempfile.TemporaryDirectory() as made:
                    done = commands.run_into(where, words(Path(made)))
                fault = commands.wrong_output(where, whole, done)
                wrong = f"{fault.upper()} {name} {where} {done.stderr[-200:]!r}"
                yield Tally({wrong if fault else f"{where}: as promised": 1})


ATTACKS: dict[str, tuple[Callable[[int, np.random.Generator], Tries], int]] = {
    "kills": (attack_kills, KILLS), "disks": (attack_disks, 1), "two at once": (attack_pairs, 20),
    "standard output": (attack_output, 1),
}  # fmt: skip


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--share", type=float, default=1.0, help="of all repetitions")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", choices=ATTACKS, action="append")
    options.add_argument("--log", type=Path, help="keep what was tried")
    given = options.parse_args()
    warnings.simplefilter("error")  # in all processes that are forked from this one
    bad = False
    commands.warm()
    print(HEAD)
    for name in given.only or ATTACKS:
        attack, count = ATTACKS[name]
        bad |= told(name, attack(max(1, round(count * given.share)), np.random.default_rng(given.seed)), Log(given.log))
    return int(bad)


if __name__ == "__main__":
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    sys.exit(main())
