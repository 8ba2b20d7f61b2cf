"""Exports as plants have them, of loops whose truth is known: read as they are, and diagnosed rightly."""

import json
import re

import pytest

from tests.support.command import run
from tests.support.hints import hints
from tests.support.messy_exports import EXPORTS, Export, gaps, manual_test

RIGHT_CODES = {"other oscillation": 0}  # else 1: something needs attention
NOTES = {  # what the reader says of the file
    "german": "Numbers were read with a decimal comma",
    "excel": "Lines 1 to 3 were passed over",
    "deltav": "Line 2 holds units and was passed over",
    "pi_long": "70 values of 'Value' with bad quality",
    "milliampere": "its span was taken as 4 .. 20",
    "fraction": "The OP span was taken as 0 .. 1;",
    "gaps": "Time is missing in 3 places",
    "modes": "Manual in 380 rows",
    "newest_first": "Rows stood newest first",
}


def diagnosed(capsys, folder, export):
    """Code, what was printed, and the result; a single command that an error prints is followed."""
    file, out = folder / export.name, folder / "found.json"
    file.write_bytes(export.content)
    words = ("diagnose", file, "--out", out)
    code, text, error = run(capsys, *words)
    if not out.exists():
        (pasted,) = hints(error)
        code, text, error = run(capsys, *pasted)
    assert error == ""
    return code, " ".join(text.split()), json.loads(out.read_text())


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", EXPORTS)
def test_verdict_size_and_severity_are_those_of_the_loop(capsys, tmp_path, name):
    export = EXPORTS[name]()
    code, text, found = diagnosed(capsys, tmp_path, export)
    assert found["verdict"] == export.verdict
    assert code == RIGHT_CODES.get(export.verdict, 1)
    assert NOTES.get(name, "") in text
    if not export.size:
        assert found["severity"] == "none"
        assert max(found["excluded"].values()) < 1.0  # % of span: it also clears the valve
        return
    low, high = found["interval_95"]
    assert low <= export.size <= high
    assert found["size_percent"] == pytest.approx(100.0 * found["size"] / (export.span[1] - export.span[0]))
    if found["severity"] != export.severity:  # only where the limit of a class lies within the interval, and is named
        assert "over the interval), confidence" in text
        assert export.severity in text.split("severity ")[1].split(" over the interval")[0]
    assert text.split("Next: ")[1].startswith("lostmotion solve ")


@pytest.mark.parametrize(("backlash", "verdict"), [(0.0, "none"), (1.5, "backlash"), (3.0, "backlash")])
def test_the_test_that_is_advised_where_a_record_cannot_tell_does(capsys, tmp_path, backlash, verdict):
    _, text, found = diagnosed(capsys, tmp_path, gaps(seed=105))
    assert (found["verdict"], found["severity"]) == ("cannot tell", "unknown")
    said = r"step OP from ([\d.]+) up by ([\d.]+), hold (\d+) s, .*; twice, then twice with steps of ([\d.]+)\."
    start, large, hold, small = map(float, re.search(said, text).groups())
    export = Export("in manual.csv", manual_test(start, (large, large, small, small), int(hold), backlash), verdict)
    folder = tmp_path / "test"
    folder.mkdir()
    code, _, found = diagnosed(capsys, folder, export)
    assert (found["verdict"], code) == (verdict, int(backlash > 0))
    if backlash:
        assert found["interval_95"][0] <= backlash <= found["interval_95"][1]
