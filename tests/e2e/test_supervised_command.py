"""`lostmotion export --supervised` as a new user runs it."""

import json

import pytest

from lostmotion.compensate.supervised import SupervisedBlock
from tests.support.command import run
from tests.support.exports import block


@pytest.fixture
def saved(tmp_path):
    path = tmp_path / "block.json"
    path.write_text(json.dumps(block("backlash").to_dict()), encoding="utf-8")
    return path


def test_files_and_proof(capsys, saved, tmp_path):
    out = tmp_path / "fy"
    words = ("--name", "FY_101", "--date", "2026-01-31", "--out", out, "--replay", 1_000)
    code, text, _ = run(capsys, "export", saved, *words, "--supervised", "--supervise", "timeout=20")
    assert code == 0
    assert "agrees with the simulated block in 1000 scans" in text
    assert "Supervised: passive until" in text
    assert "timeout : DINT := 20;" in (out / "FY_101.st").read_text(encoding="utf-8")
    known = SupervisedBlock.from_dict(json.loads((out / "FY_101_supervisor.json").read_text(encoding="utf-8")))
    assert known.settings["timeout"] == 20.0
    assert "### Supervision" in (out / "FY_101_commissioning.md").read_text(encoding="utf-8")


def test_settings_of_no_supervision_are_refused(capsys, saved, tmp_path):
    words = ("--name", "FY_101", "--date", "2026-01-31", "--out", tmp_path / "fy")
    code, _, said = run(capsys, "export", saved, *words, "--supervise", "timeout=20")
    assert code != 0
    assert "--supervised" in said
    assert not (tmp_path / "fy").exists()
    code, _, said = run(capsys, "export", saved, *words, "--supervised", "--supervise", "timeuot=20")
    assert code != 0
    assert "timeout" in said
