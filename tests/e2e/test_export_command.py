"""`lostmotion export` as a new user runs it."""

import json

import pytest

import lostmotion as lm
from lostmotion.export import TARGETS, Exported, Replay
from tests.support.command import run
from tests.support.fits import made_fit

pytestmark = pytest.mark.statistics
BASICS = ("--name", "FY_101", "--date", "2026-01-31")


@pytest.fixture(scope="module")
def fit(tmp_path_factory):
    loop = lm.routine_operation(3000, drift="none", seed=3)
    record = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1, source="LIC-7.csv")
    found = lm.identify(record, orders=(3, 2, 3), nonlinearity="dead zone")
    path = tmp_path_factory.mktemp("fit") / "fit.json"
    return found, found.save(path)


@pytest.mark.parametrize("to", TARGETS)
def test_from_a_fit_to_files_and_proof(capsys, fit, tmp_path, to):
    found, path = fit
    code, text, _ = run(
        capsys, "export", path, *BASICS, "--to", to, "--span", -20, 20, "--out", tmp_path / "fy", "--replay", 2000
    )
    assert code == 0
    assert "agrees with the simulated block in 2000 scans" in text
    assert "lower end of the 95% interval" in text
    files = {file.name: file.read_text() for file in (tmp_path / "fy").iterdir()}
    assert "FY_101_vectors.csv" in files
    assert "FY_101_commissioning.md" in files
    assert len(files) == (4 if to == "c" else 3)
    code_text = "".join(text for name, text in files.items() if "_" not in name.removeprefix("FY_101"))
    assert "LIC-7.csv" in code_text
    assert found.data.fingerprint in code_text


def test_settings_are_those_of_the_fit(capsys, fit, tmp_path):
    found, path = fit
    words = (
        "export",
        path,
        *BASICS,
        "--span",
        -20,
        20,
        "--op-noise",
        0.1,
        "--out",
        tmp_path,
        "--replay",
        100,
        "--json",
    )
    code, text, _ = run(capsys, *words)
    assert code == 0
    data = json.loads(text)
    assert data["replay"]["agrees"]
    wanted = found.block(span=(-20.0, 20.0), op_noise=0.1).settings
    assert data["block"]["settings"] == pytest.approx(wanted)


def test_without_options_the_block_is_that_of_the_fit(capsys, tmp_path):
    """The noise of OP is in the file, so the command line and Python give one block to the last bit."""
    for kind in ("dead zone", "backlash", "stiction"):
        made = made_fit(kind)
        path = made.save(tmp_path / f"{kind}.json")
        words = ("export", path, *BASICS, "--out", tmp_path / kind, "--replay", 100, "--json")
        code, text, _ = run(capsys, *words)
        assert code == 0
        block = json.loads(text)["block"]
        assert lm.CompensatorBlock.from_dict(block) == made.block()
        assert any("noise of OP" in note and "from the record" in note for note in block["notes"])


def test_a_saved_block_is_exported_as_it_is(capsys, fit, tmp_path):
    block = fit[0].block(span=(-20.0, 20.0))
    path = tmp_path / "block.json"
    path.write_text(json.dumps(block.to_dict()), encoding="utf-8")
    words = ("export", path, *BASICS, "--to", "l5x", "--real", "real", "--out", tmp_path, "--json", "--replay", 0)
    code, text, _ = run(capsys, *words, "--set", "cap=2.5")
    assert code == 0
    assert json.loads(text)["block"]["settings"] == {**block.settings, "cap": 2.5}
    assert json.loads(text)["replay"] is None
    code, _, error = run(capsys, *words, "--force", "--scan-time", 7)
    assert code == 2
    assert "scan time" in error


def test_refuses_to_overwrite(capsys, fit, tmp_path):
    words = ("export", fit[1], *BASICS, "--span", -20, 20, "--out", tmp_path, "--replay", 100)
    assert run(capsys, *words)[0] == 0
    before = (tmp_path / "FY_101.st").read_text()
    code, _, error = run(capsys, *words, "--factor", 0.1)
    assert code == 1
    assert "--force" in error
    assert (tmp_path / "FY_101.st").read_text() == before
    assert run(capsys, *words, "--factor", 0.1, "--force")[0] == 0
    assert (tmp_path / "FY_101.st").read_text() != before


def test_code_that_differs_is_not_written(capsys, fit, tmp_path, monkeypatch):
    bad = Replay(100, 0.5, 3, "scan 7, OP_OUT: 1 instead of 2", 1e-12)
    monkeypatch.setattr(Exported, "replay", lambda *_: bad)
    code, text, _ = run(capsys, "export", fit[1], *BASICS, "--span", -20, 20, "--out", tmp_path / "new")
    assert code == 1
    assert "Nothing written" in text
    assert "scan 7" in text
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("--name", "step"), "name"),
        (("--date", "today"), "YYYY-MM-DD"),
        (("--to", "ladder"), "'st'"),
        (("--real", "float"), "lreal"),
        (("--set", "cap"), "name=number"),
        (("--set", "caps=1"), "caps"),
        (("--span", 0, 1), "span"),
    ],
)
def test_what_cannot_be_used_is_said(capsys, fit, tmp_path, change, said):
    code, _, error = run(capsys, "export", fit[1], *BASICS, "--span", -20, 20, "--out", tmp_path / "new", *change)
    assert code == 2
    assert error.startswith("error: expected")
    assert said in error
    assert not (tmp_path / "new").exists()


def test_missing_options_are_usage(capsys, fit):
    assert run(capsys, "export", fit[1])[0] == 2


def test_a_fit_without_lost_motion_has_no_block(capsys, fit, tmp_path):
    data = fit[0].to_dict() | {"preferred": "none", "status": "NOT_SEEN"}
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    code, _, error = run(capsys, "export", path, *BASICS, "--out", tmp_path / "new")
    assert code == 1
    assert "NOT_SEEN" in error
    path.write_text("{}", encoding="utf-8")
    assert run(capsys, "export", path, *BASICS, "--out", tmp_path / "new")[0] == 1
    assert run(capsys, "export", tmp_path / "none.json", *BASICS, "--out", tmp_path / "new")[0] == 2
