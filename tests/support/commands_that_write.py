"""Every command as it is typed: what it writes, what it says, and how it ends."""

import io
import json
import os
import subprocess
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import lostmotion as lm
from lostmotion.cli import main
from lostmotion.cli.output import OutputOptions
from lostmotion.files import write_columns
from lostmotion.files.follow import Follower
from tests.support import state_of_online as online
from tests.support.exports import block
from tests.support.killed import begun, ended, forked, threads_of_polars

Words = Callable[[Path], list[str]]
KNOWN = ["--orders", "3,2,3", "--noise", "white", "--nonlinearity", "dead zone"]
ZONE = ["--left", "48", "--right", "52", "--gain", "1.5", "--time-constant", "30", "--dead-time", "4", "--dt", "1"]
LOOP = ["--width", "2", "--gain", "1", "--time-constant", "10", "--dead-time", "2", "--dt", "0.5", "--op-now", "50"]
RUNS = ["--noise-deviation", "0.02", "--runs", "2", "--samples", "1500", "--kp", "2", "--ki", "0.5"]
TEST = ["--noise-deviation", "0.2", "--op-limits", "40", "60", "--hold", "20", "--duration", "600"]
ONLINE = ["--orders", "1,0,1", "--noise", "white", "--start-samples", "300", "--report-every", "200", "--no-follow"]
OUTPUTS = ("a closed pipe", "a pipe closed behind a line", "a full disk", "none at all")


@dataclass(frozen=True)
class Given:
    """Files that commands read."""

    record: str
    other: str
    fit: str
    block: str
    growing: str


@dataclass(frozen=True)
class Pair:
    """Two commands that write the same; whether one of them must be refused, and whether what is there is whole."""

    both: tuple[Words, Words]
    one_only: bool
    whole: Callable[[Path], bool]


def prepare(folder):
    """Make the files, in a process of their own."""
    assert forked(lambda: _make(folder)) == 0
    at = {"record": "LIC-7.csv", "other": "LIC-8.csv", "fit": "fit.json", "block": "block.json", "growing": "grow.csv"}
    return Given(**{name: str(folder / file) for name, file in at.items()})


def _make(folder):
    loop = lm.routine_operation(2000, drift="none", seed=3)
    table = {"time_s": loop.time, "SP": loop.reference, "PV": loop.measured, "OP": loop.command}
    write_columns(folder / "LIC-7.csv", table)
    write_columns(folder / "LIC-8.csv", {name: values[:1500] for name, values in table.items()})
    given = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1, source="LIC-7.csv")
    lm.identify(given, orders=(3, 2, 3), noise="white", nonlinearity="dead zone").save(folder / "fit.json")
    OutputOptions().write_json(folder / "block.json", block("backlash").to_dict())
    (folder / "grow.csv").write_text(online.rows(1200))


def writing(given):
    """Every command with every option that names a file, for a folder where it is written."""
    identify = ["identify", given.record, *KNOWN]
    return {
        "identify --figure": lambda at: [*identify, "--figure", f"{at}/a.png"],
        "identify --figure pdf": lambda at: [*identify, "--figure", f"{at}/a.pdf"],
        "identify --out": lambda at: [*identify, "--out", f"{at}/a.json"],
        "identify, several, --out": lambda at: [
            "identify", given.record, given.other, *KNOWN, "--out", str(at), "--figure", str(at)],
        "diagnose --figure": lambda at: ["diagnose", given.record, "--figure", f"{at}/a.svg"],
        "diagnose --out": lambda at: ["diagnose", given.record, "--out", f"{at}/a.json"],
        "diagnose, several, --out": lambda at: ["diagnose", given.record, given.other, "--out", f"{at}/a.json"],
        "diagnose --same-loop": lambda at: [
            "diagnose", "--same-loop", given.record, given.other, "--out", f"{at}/a.json", "--figure", f"{at}/a.png"],
        "simulate --figure": lambda at: ["simulate", *LOOP, *RUNS, "--figure", f"{at}/a.png"],
        "simulate --out": lambda at: ["simulate", *LOOP, *RUNS, "--out", f"{at}/a.json"],
        "simulate --block-out": lambda at: ["simulate", *LOOP, *RUNS, "--block-out", f"{at}/b.json"],
        "design --out": lambda at: ["design", *ZONE, *TEST, "--out", f"{at}/a.csv"],
        "design --figure": lambda at: ["design", *ZONE, *TEST, "--figure", f"{at}/a.png"],
        "compensate --out": lambda at: ["compensate", given.record, "--left", "-1", "--right", "1",
                                        "--out", f"{at}/a.parquet"],
        "export --out": lambda at: exported(given, at / "fy"),
        "export, folder that is there": lambda at: exported(given, at),
        "online --state": lambda at: ["online", given.growing, *ONLINE, "--state", f"{at}/state"],
        "paper --out": lambda at: ["paper", "--seeds", "1", "--samples", "20000", "--method", "ml",
                                   "--control-seeds", "2", "--out", f"{at}/paper.html"],
        "solve --out": lambda at: ["solve", given.record, "--op-span", "-50", "50", "--known-gain", "2.2222",
                                   "--accept", "a test says so", "--out", f"{at}/b.json"],
    }  # fmt: skip


FILES_ONLY = ("export --out", "export, folder that is there", "compensate --out")  # nothing to say but where it is


def exported(given, folder, *words):
    return ["export", given.block, "--name", "FY_101", "--date", "2026-01-31", "--replay", "200", "--out", str(folder),
            *words]  # fmt: skip


def saying(given):
    """Every command, as text and as JSON, and its help."""
    made = {name: words for name, words in writing(given).items() if "," not in name or "several" in name}
    plain = {
        "check": ["check", given.record], "check, several": ["check", given.record, given.other],
        "check, an error": ["check", "none.csv"], "identify": ["identify", given.record, *KNOWN],
        "identify, several": ["identify", given.record, given.other, *KNOWN],
        "diagnose, several": ["diagnose", given.record, given.other], "design": ["design", *ZONE, *TEST],
        "solve, a closed gate": ["solve", given.record],
    }  # fmt: skip
    made |= {name: lambda at, words=words: words for name, words in plain.items()}
    as_json = {f"{name} --json": lambda at, words=words: [*words(at), "--json"] for name, words in made.items()}
    commands = ("", "check", "diagnose", "identify", "compensate", "simulate", "design", "export", "online", "paper")
    helped = {f"{name} --help": lambda at, name=name: [*name.split(), "--help"] for name in (*commands, "solve")}
    return made | as_json | helped | {"--version": lambda at: ["--version"]}


def pairs(given):
    """What two may begin at once."""

    def code(folder):
        made = {path.name: path.read_text() for path in (folder / "fy").iterdir()}
        if set(made) != {"FY_101.st", "FY_101_vectors.csv", "FY_101_commissioning.md"}:
            return False
        days = {day for text in made.values() for day in ("2026-01-31", "2026-02-01") if day in text}
        return len(days) == 1

    def there(at, *words):
        (at / "fy").mkdir(exist_ok=True)
        return [*exported(given, at / "fy"), *words]

    def later(words):
        return [word.replace("2026-01-31", "2026-02-01") for word in words]

    def figure(at):
        return ["simulate", *LOOP, *RUNS, "--figure", f"{at}/a.png"]

    def watch(at):
        return ["online", given.growing, *ONLINE, "--state", f"{at}/state"]

    def kept(folder):
        done = run([*watch(folder)])
        return done.stderr == "" and "Goes on after sample 1200" in done.stdout

    def drawn(folder):
        return (folder / "a.png").read_bytes().endswith(b"IEND\xaeB`\x82")

    return {
        "two exports, new folder": Pair(
            (lambda at: exported(given, at / "fy"), lambda at: later(exported(given, at / "fy"))), True, code),
        "two exports, a folder that is there": Pair((there, lambda at: later(there(at))), True, code),
        "two exports --force": Pair(
            (lambda at: there(at, "--force"), lambda at: later(there(at, "--force"))), False, code),
        "two figures of one name": Pair((figure, figure), True, drawn),
        "two figures --force": Pair(((lambda at: [*figure(at), "--force"]),) * 2, False, drawn),
        "two online, one state": Pair((watch, watch), False, kept),
    }  # fmt: skip


class Running:
    """A command in a process forked from this one, which has everything loaded: it takes no time to begin."""

    def __init__(self, words, out=None):
        self.words = words
        self.said = [tempfile.TemporaryFile() for _ in range(2)]  # noqa: SIM115
        wanted = self.said[0].fileno() if out is None else out
        self.process = begun(lambda: main(words), out=wanted, error=self.said[1].fileno())

    def ended(self):
        code = ended(self.process)
        out, error = ((stream.seek(0), stream.read().decode(), stream.close())[1] for stream in self.said)
        return subprocess.CompletedProcess(self.words, code, out, error)


def run(words, out=None):
    return Running(words, out).ended()


def warm():
    """Load and compile what commands need, without the threads of Polars, which a fork would lose."""
    loop = lm.routine_operation(2000, drift="none", seed=3)
    record = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1)
    fit = lm.identify(record, orders=(3, 2, 3), noise="white", nonlinearity="dead zone")
    lm.diagnose(record)
    fit.plot().savefig(io.BytesIO(), format="png")
    lm.export.export(block("backlash"), "st", name="FY_101", date="2026-01-31").replay(50)
    assert not threads_of_polars()


def outcome(done):
    """How a command ended, by its class."""
    lines = done.stderr.splitlines()
    if done.returncode < 0:
        return f"SIGNAL {done.returncode}"
    if "Traceback" in done.stderr:
        return f"TRACEBACK {lines[-1][:150]!r}"
    if not lines:
        return "done" if done.returncode in (0, 1) else f"EXIT {done.returncode}"
    if done.returncode == 1 and len(lines) == 1 and lines[0].startswith("error: expected"):
        return "refused in one line"
    return f"MANY LINES {done.stderr[:200]!r}"


def run_into(where, words):
    """Run a command with its standard output elsewhere."""
    if where == "a full disk":
        with Path("/dev/full").open("w") as full:
            return run(words, full.fileno())
    if where == "none at all":
        return run(words, -1)
    reading, writing = os.pipe()
    if where == "a closed pipe":
        os.close(reading)
    running = Running(words, writing)
    os.close(writing)
    if where != "a closed pipe":
        os.read(reading, 1)
        os.close(reading)
    return running.ended()


def wrong_output(where, whole, done):
    """What is not as promised, in a word; empty where all is."""
    if done.returncode < 0 or "Traceback" in done.stderr or "Exception ignored" in done.stderr:
        return "traceback"
    if where == "a full disk" and whole.stdout:
        said = done.stderr.splitlines()
        right = done.returncode in (1, 2) and len(said) == 1 and said[0].startswith("error: expected room on standard")
        return "" if right else "not told"
    if done.stderr != whole.stderr:
        return "other words"
    quiet = whole.args[0] == "online" or "--help" in whole.args or "--version" in whole.args
    return "" if done.returncode == whole.returncode or (quiet and done.returncode == 1) else "another code"


def contents(folder):
    """Files and what is in them; the lock beside a state is empty and stays."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b""
        for path in folder.rglob("*")
        if not path.name.endswith(".lock")
    }


def keep(path, data):
    """A result that grows, as a batch writes it."""
    OutputOptions(force=True).keeper(path)(data)


def position(folder):
    """Write the place in a record as a follower says it."""
    path = folder / "a.csv"
    path.write_text(online.rows(100))
    with Follower(path) as follower:
        follower.read(80)
        follower.read(80)
        (folder / "position").write_text(json.dumps(follower.position))
