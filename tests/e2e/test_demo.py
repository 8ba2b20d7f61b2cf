"""``lostmotion demo``: the whole way on a simulated loop, without make."""

import re

import pytest

from lostmotion.cli import main
from tests.support.places import ROOT


def demo(capsys, *words):
    with pytest.raises(SystemExit) as stop:
        main(["demo", *map(str, words)])
    return (int(stop.value.code or 0), *capsys.readouterr())


def test_the_inverse_that_was_found_takes_the_dead_zone_away(tmp_path, capsys, monkeypatch):
    folder = tmp_path / "demo"
    code, text, error = demo(capsys, folder)
    assert (code, error) == (0, "")
    sound, faulty, compensated = map(float, re.findall(r"^  [a-z ,]+ (0\.\d+)$", text, re.MULTILINE))
    assert sound < compensated < 1.2 * sound < 0.5 * faulty
    names = ["LIC-101-compensated.csv", "LIC-101.csv", "LIC-101.json", "LIC-101.png"]
    assert sorted(path.name for path in folder.iterdir()) == names
    code, text, error = demo(capsys, folder)
    assert (code, text) == (1, "")
    assert "--force" in error
    monkeypatch.setattr("lostmotion.extras.find_spec", lambda name: None)
    code, text, error = demo(capsys, folder, "--force")
    assert (code, error) == (0, "")
    assert text.endswith('run: pip install "lostmotion[plot]"\n')


def test_make_runs_it():
    assert "lostmotion demo demo-output --force" in (ROOT / "Makefile").read_text(encoding="utf-8")
