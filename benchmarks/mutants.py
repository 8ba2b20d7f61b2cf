"""Small faults put into the source, one at a time: does the short stage of the tests find them?

Run: ``python benchmarks/mutants.py`` (--seed for another sample, --near for a quick count, --from to go on)

Faults are drawn at random, so many of each package: a sign, a bound that is turned round, a unit, two arguments that
are swapped, a check that is removed. For each the tests of the short stage that run the line are asked, those of its
own package first, until one fails. The coverage that tells them is taken once. All happens in copies of the repository.
"""

from __future__ import annotations

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path
from queue import Queue

from coverage import CoverageData

ROOT = Path(__file__).resolve().parents[1]
SOURCE = Path("src") / "lostmotion"
SHARES = {"identify": 6, "diagnose": 5, "files": 5, "compensate": 3, "export": 3, "records": 2, "store": 2, "web": 4}
CHUNKS = (30, 300, 3000)  # tests that are asked together, the nearest first
SECONDS = 900.0  # for one chunk: a fault may make a loop that never ends
SHORT = ("-m", "not long")
TURNED = {ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
OPPOSITE = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult}
TEN = 10.0  # a unit that is wrong
LEAST = 1e-3  # smaller numbers are tolerances, and a tenth of them does the same
EITHER_WAY = ("max", "min")  # whose arguments may be swapped


@dataclass(frozen=True)
class Fault:
    """One change of one place.

    Attributes
    ----------
    file : Path
        Below the repository.
    line : int
    kind : str
    before, after : str
        Source of the expression or statement.
    text : str
        The whole file with it.
    """

    file: Path
    line: int
    kind: str
    before: str
    after: str
    text: str

    def __str__(self) -> str:
        return f"{self.file.relative_to(SOURCE)}:{self.line} {self.kind}: `{self.before}` -> `{self.after}`"


def changes(node: ast.AST) -> Iterator[tuple[str, Callable[[], ast.AST]]]:
    """Faults that a node can have, each with a copy of it that has the fault."""
    if isinstance(node, ast.BinOp) and type(node.op) in OPPOSITE and not isinstance(node.left, ast.Constant):
        yield "sign", lambda: ast.BinOp(node.left, OPPOSITE[type(node.op)](), node.right)
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.Div) and _number(node.left):
        yield "unit", lambda: ast.BinOp(ast.Constant(node.left.value / TEN), node.op, node.right)
    if isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in TURNED:
        yield "bound", lambda: ast.Compare(node.left, [TURNED[type(node.ops[0])]()], node.comparators)
    if isinstance(node, ast.Call) and _can_be_swapped(node):
        yield "swapped", lambda: ast.Call(node.func, [node.args[1], node.args[0], *node.args[2:]], node.keywords)
    if isinstance(node, ast.If) and not node.orelse and isinstance(node.body[0], ast.Raise):
        yield "check", ast.Pass


def _can_be_swapped(node: ast.Call) -> bool:
    names = len(node.args) > 1 and all(isinstance(one, ast.Name) for one in node.args[:2])
    return names and ast.unparse(node.func).rpartition(".")[2] not in EITHER_WAY


def _number(node: ast.AST) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, float) and abs(node.value) >= LEAST


def faults_of(file: Path) -> Iterator[Fault]:
    """All faults that a file can have, inside of functions."""
    text = (ROOT / file).read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    starts = [0]
    for line in lines:
        starts.append(starts[-1] + len(line.encode()))
    whole = text.encode()
    for function in ast.walk(ast.parse(text)):
        if not isinstance(function, ast.FunctionDef) or function.name.startswith("__"):
            continue
        for node in (one for statement in function.body for one in ast.walk(statement)):
            for kind, changed in changes(node):
                first, last = (
                    starts[node.lineno - 1] + node.col_offset,
                    starts[node.end_lineno - 1] + node.end_col_offset,
                )
                after = ast.unparse(ast.fix_missing_locations(changed()))
                put = f"({after})" if isinstance(node, ast.expr) else after
                before = " ".join(whole[first:last].decode().split())
                yield Fault(
                    file, node.lineno, kind, before, after, (whole[:first] + put.encode() + whole[last:]).decode()
                )


def drawn(seed: int) -> list[Fault]:
    """So many of each package, kinds as even as can be, no file twice."""
    chosen = []
    for package, count in SHARES.items():
        draw = random.Random(f"{seed} {package}")  # noqa: S311
        files = sorted((ROOT / SOURCE / package).rglob("*.py"))
        found = [fault for file in files for fault in faults_of(file.relative_to(ROOT))]
        draw.shuffle(found)
        kinds = sorted({fault.kind for fault in found})
        draw.shuffle(kinds)
        mine: list[Fault] = []
        for kind in islice(cycle(kinds), 10 * count):
            taken = {one.file for one in mine}
            one = next((one for one in found if one.kind == kind and one.file not in taken), None)
            mine += [one] if one is not None and len(mine) < count else []
        chosen += mine
    return chosen


def tests_of(fault: Fault, covered: CoverageData) -> list[str]:
    """Tests that run the line, those of its own package first."""
    name = next((one for one in covered.measured_files() if one.endswith(fault.file.as_posix())), None)
    contexts = covered.contexts_by_lineno(name).get(fault.line, []) if name else []
    tests = {context.rpartition("|")[0] for context in contexts if context}
    package = fault.file.relative_to(SOURCE).parts[0]
    return sorted(tests, key=lambda one: (f"tests/unit/{package}/" not in one, "tests/unit/" not in one, one))


def tests_near(fault: Fault, there: set[str]) -> list[str]:
    """Tests of the package, and of files that name it; those that name the module first. Not all that run the line."""
    package, module = fault.file.relative_to(SOURCE).parts[0], ".".join(fault.file.with_suffix("").parts[1:])
    near: dict[str, int] = {}
    for name in {test.partition("::")[0] for test in there}:
        text = (ROOT / name).read_text(encoding="utf-8")
        rank = 0 if module in text else 1 if f"tests/unit/{package}/" in name else 2 if package in text else None
        if rank is not None and not name.startswith("src/"):
            near[name] = rank
    tests = [test for test in there if test.partition("::")[0] in near]
    return sorted(tests, key=lambda test: (near[test.partition("::")[0]], test))


def outcome(fault: Fault, tests: list[str], copy: Path) -> str:
    """What became of it: "found by TEST", "NOT RUN" by any test, or "NOT FOUND" by so many."""
    if not tests:
        return "NOT RUN by any test of the short stage"
    place = copy / fault.file
    sound = place.read_text(encoding="utf-8")
    begun = 0
    for size in CHUNKS:
        asked, begun = tests[begun : begun + size], begun + size
        place.write_text(fault.text, encoding="utf-8")
        try:
            found = failed(asked, copy) if asked else ""
        finally:
            place.write_text(sound, encoding="utf-8")
        if found and not failed([found], copy):  # without the fault it passes
            return f"found by {found}"
    return f"NOT FOUND by {len(tests)} tests"


def failed(tests: list[str], copy: Path) -> str:
    """First of these tests that fails, or of those that never end; "" where none does."""
    words = [sys.executable, "-m", "pytest", "-x", "-q", *SHORT, "--tb=no", "-p", "no:cacheprovider", *tests]
    path = {"PYTHONPATH": str(copy / "src"), "PYTHONDONTWRITEBYTECODE": "1", "CI": "1"}
    try:
        done = subprocess.run(
            words, cwd=copy, env=os.environ | path, capture_output=True, text=True, timeout=SECONDS, check=False
        )
    except subprocess.TimeoutExpired:
        return tests[0]
    if done.returncode in (0, 5):
        return ""
    lines = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return lines[0].split(" - ")[0].split(" ", 1)[1] if lines else tests[0]


def present() -> set[str]:
    """Tests of the short stage that there are."""
    words = [sys.executable, "-m", "pytest", "--collect-only", "-q", *SHORT]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    return {line for line in done.stdout.splitlines() if "::" in line}


def coverage_of(file: Path | None, folder: Path) -> CoverageData:
    """Of the short stage, with the test that ran each line; taken where it is not given, in half an hour."""
    if file is None:
        file = folder / ".coverage"
        words = [sys.executable, "-m", "pytest", "-n", "3", "-q", *SHORT, "--cov", "--cov-context=test"]
        wanted = {"COVERAGE_FILE": str(file), "CI": "1"}
        subprocess.run([*words, "--cov-report="], cwd=ROOT, env=os.environ | wanted, check=False)
    covered = CoverageData(str(file))
    covered.read()
    return covered


def copied(folder: Path) -> Path:
    """A clone with what lies in the working tree, its kernels compiled."""
    subprocess.run(["git", "clone", "-q", str(ROOT), str(folder)], check=True)  # noqa: S607
    if (ROOT.parent / "shared").exists() and not (folder.parent / "shared").exists():
        (folder.parent / "shared").symlink_to(ROOT.parent / "shared")
    vendor = Path("src/lostmotion/web/static/vendor")
    if (ROOT / vendor).exists():
        shutil.copytree(ROOT / vendor, folder / vendor)
    words = [sys.executable, "-m", "lostmotion", "warm-up"]
    subprocess.run(words, cwd=folder, env=os.environ | {"PYTHONPATH": str(folder / "src")}, check=True)
    return folder


def main() -> int:
    """Draw, run, print a table."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seed", type=int, default=0)
    asked.add_argument("--from", type=int, default=1, dest="first", help="number of the fault to begin with")
    asked.add_argument("--at-once", type=int, default=2)
    asked.add_argument("--coverage", type=Path, help="of the short stage with contexts; without it, it is taken")
    asked.add_argument("--near", action="store_true", help="ask tests that are near instead: minutes, and fewer found")
    asked.add_argument("--list", action="store_true", help="print the faults only")
    given = asked.parse_args()
    faults = dict(enumerate(drawn(given.seed), start=1))
    faults = {number: fault for number, fault in faults.items() if number >= given.first}
    if given.list:
        print(*(f"{number}. {fault}" for number, fault in faults.items()), sep="\n")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        there = present()
        covered = None if given.near else coverage_of(given.coverage, Path(folder))
        tests = [
            tests_near(fault, there) if covered is None else [one for one in tests_of(fault, covered) if one in there]
            for fault in faults.values()
        ]
        copies: Queue[Path] = Queue()
        for number in range(given.at_once):
            copies.put(copied(Path(folder) / f"copy{number}"))

        def run(number: int, asked: list[str]) -> bool:
            copy = copies.get()
            try:
                said = outcome(faults[number], asked, copy)
            finally:
                copies.put(copy)
            print(f"{number}. {faults[number]}\n    {said}", flush=True)
            return said.startswith("found")

        with ThreadPoolExecutor(given.at_once) as pool:
            found = list(pool.map(run, faults, tests))
    print(f"found: {sum(found)} of {len(found)}")
    return 0 if sum(found) >= 0.9 * len(found) else 1


if __name__ == "__main__":
    raise SystemExit(main())
