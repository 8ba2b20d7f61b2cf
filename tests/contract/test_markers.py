"""The stages of the tests: what is in which, and that together they are all."""

import re
import subprocess
import sys
from pathlib import Path

from tests import conftest
from tests.support.places import ROOT

MAKEFILE = (ROOT / "Makefile").read_text(encoding="utf-8")


def test_the_short_stage_leaves_out_what_is_long_and_the_other_nothing():
    expressions = re.findall(r'pytest[^\n]*-m "([^"]+)"', MAKEFILE)
    assert expressions == ["not long", "kernels and not long and not statistics"]
    assert ".ci/run" not in MAKEFILE
    ran = re.findall(r"^make (.+)$", (ROOT / ".ci" / "run").read_text(encoding="utf-8"), re.MULTILINE)
    assert ran == ["test", "test-all"]


def long_cases(*words):
    """Of one file with samples, as they would be run."""
    file = "tests/unit/models/test_backlash.py"
    words = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-m", "long", *words, file]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    return [line for line in done.stdout.splitlines() if "::" in line]


def test_samples_are_the_same_in_random_order():
    in_order, at_random = long_cases(), long_cases("-p", "randomly", "--randomly-seed=1")
    assert at_random != in_order
    assert sorted(at_random) == sorted(in_order)


def test_tests_of_kernels_and_twins_run_without_the_jit():
    found = {path.name for path in (ROOT / "tests" / "unit").rglob("test_*.py") if conftest.tests_kernels(path)}
    assert {"test_against_twins.py", "test_lanes.py", "test_ml_twin.py", "test_slips.py"} <= found
    assert not conftest.tests_kernels(ROOT / "tests" / "unit" / "files" / "test_times.py")


class Case:
    """An item of a test with a number of cases, some of which are kept."""

    def __init__(self, number, kept):
        self.path, self.originalname, self.number, self.kept = Path("test_a.py"), "test", number, kept

    def get_closest_marker(self, name):
        return type("Mark", (), {"args": (self.kept,)})() if name == "sampled" and self.kept else None


def test_a_sample_has_cases_from_beginning_to_end():
    for count, kept in ((10, 4), (7, 3), (100, 1), (3, 8)):
        left = {case.number for case in conftest.left_of_samples([Case(number, kept) for number in range(count)])}
        assert len(left) == max(count - kept, 0)
        assert 0 not in left
    assert list(conftest.left_of_samples([Case(number, None) for number in range(5)])) == []
