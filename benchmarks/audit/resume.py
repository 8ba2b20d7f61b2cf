"""An audit that is killed at random points, coordinator and workers, gives the rows of one that is not.

    python -m benchmarks.audit.resume [--kills 40] [--loops 200] [--seed 1] [--databases sqlite postgresql]

Stand-in work of some milliseconds (benchmarks/audit/stand_in.py): what is tried is the machinery. Each audit runs in a
process of its own; it is killed with SIGKILL at a random step of its progress and some random milliseconds later, its
coordinator or one of its workers, five times, and then run to its end. Left out of the comparison: `seconds` of a row,
which is a measurement.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import sqlalchemy as sa
from benchmarks.audit.stand_in import STEPS, MadePlant

from lostmotion.audit.runner.engine import open_engine
from lostmotion.audit.runner.run import run_audit
from lostmotion.audit.settings import AuditSettings
from lostmotion.store.run_rows import RunState
from lostmotion.store.schema import metadata
from lostmotion.store.store import Store
from tests.support.stores import Server

WORKERS = 2
COST = 0.004  # s of an assessment
TIMES = 5  # an audit is killed, at most
LATER = 0.1  # s after a step, at most


def audit(address: str, loops: int, log: str) -> None:
    """One audit in this process; each step of its progress is a byte in a file."""
    engine = open_engine("processes", WORKERS)
    with Store(address) as store, Path(log).open("ab", buffering=0) as file:
        settings = AuditSettings(window=7200.0)
        run_audit(plant(loops), store, settings, engine, lambda _: file.write(b".") and None, steps=STEPS)
    engine.close()


def plant(loops: int) -> MadePlant:
    """Loops, some of which cannot be read or raise."""
    return MadePlant((*(f"L{number:04d}" for number in range(loops)), "bad 1", "raise 1", "late raise"), cost=COST)


def rows_of(address: str) -> tuple[dict[str, list[Any]], dict[str, int]]:
    """All tables but the run's own, without `seconds`; and how many rows there are, with and without those twice."""
    with Store(address, write=False) as store, store.engine.connect() as connection:
        tables = {}
        for table in metadata.sorted_tables:
            if table.name != "run":
                columns = [column for column in table.columns if column.name != "seconds"]
                tables[table.name] = [
                    tuple(one) for one in connection.execute(sa.select(*columns).order_by(*table.primary_key))
                ]
        keys = connection.execute(sa.text("SELECT run_id, loop_id, window_start FROM assessment")).all()
        states = [run.state for run in store.runs()]
    return tables, {"rows": len(keys), "twice": len(keys) - len(set(keys)), "runs": len(states),
                    "finished": states.count(RunState.FINISHED)}  # fmt: skip


class Audit:
    """An audit in a process of its own."""

    def __init__(self, address: str, loops: int, folder: Path) -> None:
        handle, self.log = tempfile.mkstemp(dir=folder)
        os.close(handle)
        words = ["--audit", address, "--log", self.log, "--loops", str(loops)]
        self.process = subprocess.Popen([sys.executable, "-m", "benchmarks.audit.resume", *words])

    def steps(self) -> int:
        return Path(self.log).stat().st_size

    def wait_for(self, step: int, seconds: float) -> bool:
        """Wait for a step of the progress and some seconds more; whether it is still at work."""
        while self.process.poll() is None and self.steps() < step:
            time.sleep(0.002)
        time.sleep(seconds)
        return self.process.poll() is None

    def ends(self) -> int:
        """Wait for its end; the steps that it took."""
        if self.process.wait(600) != 0:
            raise RuntimeError(f"an audit ended with {self.process.returncode}")
        return self.steps()


def children(process: int) -> list[int]:
    """Workers of a coordinator."""
    found = []
    for one in Path("/proc").glob("[0-9]*"):
        try:
            state = (one / "stat").read_text().rpartition(")")[2].split()
            words = (one / "cmdline").read_bytes()
        except OSError:
            continue
        if int(state[1]) == process and b"spawn_main" in words:
            found.append(int(one.name))
    return found


def tried(address: str, settings: argparse.Namespace, steps: int, made: random.Random, folder: Path) -> Counter[str]:
    """Audit that is killed five times and then let run to its end."""
    killed: Counter[str] = Counter()
    for _ in range(TIMES):
        one = Audit(address, settings.loops, folder)
        at_work = one.wait_for(made.randrange(steps // 2), made.uniform(0.0, LATER))
        workers = children(one.process.pid)
        if at_work and made.random() < 0.5 and workers:
            os.kill(made.choice(workers), signal.SIGKILL)
            killed["worker"] += 1
            at_work = one.wait_for(one.steps() + made.randrange(steps // 4), made.uniform(0.0, LATER))
        if not at_work:
            one.ends()
            return killed
        one.process.kill()
        one.process.wait()
        killed["coordinator"] += 1
        if finished(address):  # it was killed behind its last transaction: the next one would be a run of its own
            return killed
    Audit(address, settings.loops, folder).ends()
    return killed


def finished(address: str) -> bool:
    """Whether the run in the store has ended."""
    try:
        with Store(address, write=False) as store:
            return any(run.state is RunState.FINISHED for run in store.runs())
    except OSError:
        return False  # killed before there was a store


def database(kind: str, server: Any, folder: Path) -> str:
    """Address of an empty store."""
    if kind == "sqlite":
        return str(Path(tempfile.mkdtemp(dir=folder)) / "plant.db")
    address: str = server.database()
    return address


def compared(kind: str, server: Any, folder: Path, settings: argparse.Namespace) -> bool:
    """Kills in this kind of database; whether all was equal."""
    reference = database(kind, server, folder)
    steps = Audit(reference, settings.loops, folder).ends()
    expected, _ = rows_of(reference)
    made = random.Random(settings.seed)  # noqa: S311
    killed: Counter[str] = Counter()
    audits = same = 0
    facts: Counter[str] = Counter()
    while killed["worker"] + killed["coordinator"] < settings.kills:
        address = database(kind, server, folder)
        killed += tried(address, settings, steps, made, folder)
        found, counted = rows_of(address)
        audits += 1
        same += found == expected
        facts += Counter(counted)
        for name in expected:
            if found[name] != expected[name]:
                print(f"  differs: {name}: {len(found[name])} rows, expected {len(expected[name])}")
    print(
        f"{kind}: {killed['coordinator']} kills of the coordinator, {killed['worker']} of a worker; "
        f"{same} of {audits} audits equal to the uninterrupted one ({len(expected['assessment'])} rows), "
        f"{facts['twice']} rows twice, {facts['runs']} runs, {facts['finished']} finished", flush=True,
    )  # fmt: skip
    return same == audits and not facts["twice"] and facts["runs"] == facts["finished"] == audits


def main() -> None:
    """Kill and compare."""
    words = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    words.add_argument("--kills", type=int, default=40)
    words.add_argument("--loops", type=int, default=200)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--databases", nargs="+", default=["sqlite", "postgresql"])
    for own in ("--audit", "--log"):
        words.add_argument(own, help=argparse.SUPPRESS)
    settings = words.parse_args()
    if settings.audit:
        audit(settings.audit, settings.loops, settings.log)
        return
    server = Server() if "postgresql" in settings.databases else None
    with tempfile.TemporaryDirectory(prefix="resume-") as folder:
        try:
            equal = [compared(kind, server, Path(folder), settings) for kind in settings.databases]
        finally:
            if server is not None:
                server.stop()
    sys.exit(0 if all(equal) else 1)


if __name__ == "__main__":
    main()
