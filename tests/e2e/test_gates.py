"""The gates as the commands have them: refusals with the way out, and reasons that stay."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import Status
from lostmotion.files import write_columns
from tests.support.command import run
from tests.support.fits import made_fit

BASICS = ("--name", "FY_101", "--date", "2026-01-31", "--replay", 100)
WHY = "seen on the bench, J. Doe"


@pytest.fixture
def saved(tmp_path):
    def save(kind, status=Status.OK, **facts):
        return made_fit(kind, status, **facts).save(tmp_path / f"{kind}-{status.name}.json")

    return save


@pytest.fixture
def record(tmp_path):
    data = made_fit("dead zone").data
    return write_columns(tmp_path / "FIC-1.csv", {"time_s": 0.5 * np.arange(200), "OP": data.u, "PV": data.y})


def refused(capsys, *words, expected=1):
    """One line that says how to go on."""
    code, text, error = run(capsys, *words)
    assert code == expected
    assert text == ""
    assert error.startswith("error: expected")
    assert error.count("\n") == 1
    return error


def test_export_and_its_header(capsys, saved, tmp_path):
    path = saved("dead zone", Status.WIDE)
    words = ("export", path, *BASICS, "--out", tmp_path / "fy")
    assert "--accept REASON" in refused(capsys, *words)
    assert not (tmp_path / "fy").exists()
    assert "reason in words" in refused(capsys, *words, "--accept", "  ", expected=2)
    code, text, _ = run(capsys, *words, "--accept", WHY)
    assert code == 0
    assert f"ACCEPTED behind a closed gate: {WHY}" in text
    assert WHY in (tmp_path / "fy" / "FY_101.st").read_text()
    assert WHY in (tmp_path / "fy" / "FY_101_commissioning.md").read_text()


@pytest.mark.parametrize("verdict", ["cannot tell", "stiction"])
def test_a_diagnosis_beside_the_fit(capsys, saved, tmp_path, verdict):
    path, said = saved("backlash"), tmp_path / "diagnosis.json"
    said.write_text(json.dumps({"verdict": verdict}))
    words = ("export", path, *BASICS, "--out", tmp_path / "fy", "--diagnosis", said)
    assert verdict in refused(capsys, *words)
    assert verdict in refused(capsys, "simulate", path, "--kp", 1, "--ki", 0.1, "--diagnosis", said)
    said.write_text(json.dumps({"verdict": "backlash"}))
    assert run(capsys, *words)[0] == 0


def test_simulate_and_design(capsys, saved):
    assert "WIDE" in refused(capsys, "simulate", saved("backlash", Status.WIDE), "--kp", 1, "--ki", 0.1)
    limits = ("--op-limits", 40, 60, "--duration", 100)
    hidden = saved("dead zone", Status.NOT_SEEN, widest=3.0)
    assert "NOT_SEEN" in refused(capsys, "design", "--fit", hidden, *limits)
    assert "guess" in refused(capsys, "design", "--fit", saved("stiction"), *limits)
    unknown = saved("dead zone", Status.CANNOT_TELL)
    guess = ("--left", 49, "--right", 51)
    assert "knows the process" in refused(capsys, "design", "--fit", unknown, *guess, *limits)


def test_a_level_needs_limits_of_pv(capsys, saved):
    words = ("design", "--fit", saved("dead zone", integrating=True), "--op-limits", 40, 60, "--duration", 100)
    assert "--pv-limits LOW HIGH" in refused(capsys, *words, expected=2)


def test_compensate(capsys, saved, record, tmp_path):
    out = tmp_path / "compensated.csv"
    words = ("compensate", record, "--out", out, "--fit")
    assert "simulate" in refused(capsys, *words, saved("backlash"))
    path = saved("dead zone", Status.ONE_SIDED)
    assert "ONE_SIDED" in refused(capsys, *words, path)
    assert not out.exists()
    code, text, _ = run(capsys, *words, path, "--accept", WHY, "--json")
    assert code == 0
    assert WHY in json.loads(text)["accepted"]
    code, text, _ = run(capsys, *words, saved("dead zone"), "--force")
    assert code == 0
    assert "ACCEPTED" not in text


def test_online_watches_dead_zones(capsys, saved, record):
    error = refused(capsys, "online", record, "--fit", saved("stiction"), "--no-follow")
    assert "no other kind is watched" in error
    assert "lostmotion identify FILE --out NEW.json" in error
    path = saved("dead zone", Status.NOT_SEEN, widest=3.0)
    assert "NOT_SEEN" in refused(capsys, "online", record, "--fit", path, "--no-follow")
    code, text, _ = run(capsys, "online", record, "--fit", path, "--no-follow", "--accept", WHY)
    assert code == 1  # 200 samples are too few to begin
    first = json.loads(text.splitlines()[0])
    assert first["kind"] == "note"
    assert WHY in first["message"]


def test_a_block_with_a_reason_is_exported_with_it(capsys, tmp_path):
    path = tmp_path / "block.json"
    path.write_text(json.dumps(made_fit("backlash", Status.WIDE).block(accept=WHY).to_dict()))
    code, _, _ = run(capsys, "export", path, *BASICS, "--to", "c", "--out", tmp_path / "fy", "--set", "factor=0.5")
    assert code == 0
    code_files = [file for file in (tmp_path / "fy").iterdir() if file.suffix in (".c", ".h")]
    assert code_files
    assert all(WHY in file.read_text() for file in code_files)
    assert lm.read_block(path).accepted


def test_solve_tells_bad_input_from_a_closed_gate(capsys, tmp_path):
    code, _, error = run(capsys, "solve", tmp_path / "nothing.csv")
    assert code == 2
    assert error.startswith("error: expected a file")
    still = write_columns(
        tmp_path / "still.csv", {"t_s": np.arange(300.0), "OP": np.full(300, 42.0), "PV": np.arange(300.0) % 7}
    )
    code, text, _ = run(capsys, "solve", still)
    assert code == 1
    assert "the gate at step 'check' is closed" in text
    assert f"lostmotion check {still}" in text
    code, text, _ = run(capsys, "solve", still, "--json")
    assert json.loads(text)["outcome"] == "closed"
    assert run(capsys, "solve")[0] == 2
