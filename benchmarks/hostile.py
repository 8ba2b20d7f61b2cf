"""Attack on what lostmotion reads of its own, exports and writes: many changed inputs, and a tally of what they did.

Run: ``PYTHONPATH=. .venv/bin/python benchmarks/hostile.py`` (some 40 minutes); ``--share 0.02`` is a quick look. Prints
a table; exit code 1 where anything but a refusal in one line or a result came out. Warnings are errors, in the
processes that it starts as well.

- texts: hostile names, reasons and notes through every target of the export; the same syntax tree as with a harmless
  one, by the XML parser of Python, the preprocessor of gcc and, for ST, comments taken out
- states: one value changed at every path of a state file, or its arrays, signed anew; processes of their own
- JSON: the same for fits and blocks
- kills: processes killed while they write; whole files only
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from hostile_log import Log
from hostile_tally import HEAD, told
from lostmotion.export import TARGETS
from lostmotion.files import writer
from tests.properties.test_hostile_states import parts, sample, whole
from tests.support import state_of_online as online
from tests.support.exports import KINDS, block
from tests.support.hostile_texts import MARKS, bare, bare_of, exported
from tests.support.hostile_values import mutants
from tests.support.use_of_json import outcome
from tests.unit.files.test_writer import WRITES_FOR_EVER

TEXTS, STATES, JSONS, KILLS = 5000, 5000, 5000, 200
Tries = Iterator[Counter[str]]
AT_ONCE, PATIENCE = 100, 300  # texts or states of one process, and its seconds: nothing hangs
SIZE = 20_000  # of what is written under kills, a multiple of it


def hostile_texts(count: int, random: np.random.Generator) -> Iterator[str]:
    """Marks of all languages, characters that turn into them, and anything else, in any order."""
    for _ in range(count):
        pieces = [MARKS[k] for k in random.integers(len(MARKS), size=random.integers(1, 10))]
        odd = "".join(chr(k) for k in random.integers(1, 0xD7FF, size=random.integers(0, 4)))
        yield "x" + "".join(random.permutation([*pieces, odd]))


def attack_exports(count: int, random: np.random.Generator) -> Tries:
    """Every text through every target."""
    harmless = {to: bare(exported(to, "FIC-101.csv")) for to in TARGETS}
    texts = hostile_texts(count, random)
    while group := list(islice(texts, AT_ONCE)):
        for to in TARGETS:
            try:
                found = bare_of([exported(to, text) for text in group])
            except Exception:  # noqa: BLE001  it is what is sought: by which of them, each tells alone
                found = []
            yield sum((_of_text(to, text, harmless[to], found[k : k + 1]) for k, text in enumerate(group)), Counter())
        yield Counter({"texts": len(group)})


def _of_text(to: str, text: str, harmless: object, found: list[object]) -> Counter[str]:
    """Outcome of one text, alone where it is not known yet."""
    try:
        same = (found[0] if found else bare(exported(to, text))) == harmless
    except Exception as error:  # noqa: BLE001  it is what is sought
        return Counter({f"FAULT {type(error).__name__} {to} {text!r}"[:200]: 1})
    return Counter({"same tree" if same else f"INJECTED {to} {text!r}"[:200]: 1})


def saved_states(folder: Path) -> tuple[list[bytes], str]:
    """Two real states, before and after the start of the estimator, and the record that they are of."""
    text = online.rows(1800)
    record, state = folder / "record.csv", folder / "base"
    found = []
    for rows in (200, 1600):
        record.write_text("".join(text.splitlines(keepends=True)[: rows + 1]))
        state.unlink(missing_ok=True)
        online.start(record, state)
        found.append(state.read_bytes())
    return found, text


def attack_states(count: int, random: np.random.Generator) -> Tries:
    """Changed states, a hundred to a process."""
    with tempfile.TemporaryDirectory() as place:
        bases, text = saved_states(Path(place))
    pool = [state for base in bases for state in sample(base, 0.4, 200, int(random.integers(1 << 30)))]
    chosen = [pool[k] for k in random.permutation(len(pool))[:count]]
    for group in _groups([*(whole(*parts(base)) for base in bases), *chosen], AT_ONCE):
        yield _of_one_process(group, text)


def _groups(values: Iterable[bytes], size: int) -> Iterator[list[bytes]]:
    rest = iter(values)
    while group := list(islice(rest, size)):
        yield group


def _of_one_process(states: list[bytes], text: str) -> Counter[str]:
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "record.csv").write_text(text)
        for number, state in enumerate(states):
            (folder / f"{number:05d}.state").write_bytes(state)
        command = [sys.executable, "-W", "error", "-m", "tests.support.state_of_online", str(folder)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE)
        except subprocess.TimeoutExpired as late:
            return Counter({f"HANG {late.stdout!r}"[-200:]: 1})
        tally = Counter(_class_of(line.partition(" ")[2]) for line in done.stdout.splitlines()[:-1])
        return (
            tally if done.returncode == 0 else tally + Counter({f"SIGNAL {done.returncode} {done.stderr[-100:]!r}": 1})
        )


def _class_of(said: str) -> str:
    return "refused in one line" if said.endswith("one line") else said


def attack_json(count: int, random: np.random.Generator) -> Tries:
    """Changed fits and blocks."""
    u = lm.signals.prs(600, -5, 5, hold=8, seed=1)
    y = lm.Hammerstein(lm.DeadZone(-1.0, 1.0), lm.LinearModel((-0.8,), (0.2,), 1)).simulate(u) + 0.02 * (u % 0.37)
    fit = lm.identify(u, y, dt=1.0, nonlinearity="dead zone", orders=(1, 0, 1), noise="white").to_dict()
    blocks = [block(kind).to_dict() | {"accepted": "because"} for kind in KINDS]
    pool = [made for data in (fit, *blocks) for made in mutants(json.loads(json.dumps(data)), random)]
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "a.json"
        for k in random.permutation(len(pool))[:count]:
            path.write_text(json.dumps(pool[k]), encoding="utf-8")
            said = outcome(path)
            yield Counter({"refused in one line" if said.startswith("refused") and "MANY" not in said else said: 1})


def attack_writers(count: int, random: np.random.Generator) -> Tries:
    """Processes killed after up to 60 ms of writing; what is left is looked at after the next start's sweep."""
    for _ in range(count):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            command = [sys.executable, "-W", "error", "-c", _unindented(WRITES_FOR_EVER), place]
            with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
                assert process.stdout is not None
                process.stdout.readline()
                time.sleep(float(random.uniform(0.0, 0.06)))
                process.send_signal(signal.SIGKILL)
            writer.sweep(folder / "state")
            yield _left(folder)


def _left(folder: Path) -> Counter[str]:
    tally: Counter[str] = Counter({"kills": 1})
    for path in folder.iterdir():
        if path.name.startswith("."):
            tally["second names left over"] += 1
        elif path.is_dir():
            tally["whole folders" if len(list(path.iterdir())) == 3 else "TORN folder"] += 1
        else:
            size = path.stat().st_size
            tally["whole files" if size and size % SIZE == 0 else "TORN file"] += 1
    return tally


def _unindented(code: str) -> str:
    return "\n".join(line[4:] for line in code.splitlines())


ATTACKS: dict[str, tuple[Any, int]] = {
    "exports": (attack_exports, TEXTS), "states": (attack_states, STATES), "fits and blocks": (attack_json, JSONS),
    "kills of writers": (attack_writers, KILLS),
}  # fmt: skip


def main() -> int:
    """Print the tally; 1 where something is in capitals."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--share", type=float, default=1.0, help="of all inputs")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", choices=ATTACKS, action="append")
    options.add_argument("--log", type=Path, help="keep what was tried")
    given = options.parse_args()
    warnings.simplefilter("error")
    bad = False
    print(HEAD)
    for name in given.only or ATTACKS:
        attack, count = ATTACKS[name]
        bad |= told(name, attack(max(1, round(count * given.share)), np.random.default_rng(given.seed)), Log(given.log))
    return int(bad)


if __name__ == "__main__":
    sys.exit(main())
