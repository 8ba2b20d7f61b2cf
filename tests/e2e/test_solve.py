"""``lostmotion solve`` as a new user runs it: to the block, or to commands that can be pasted."""

import json
import shlex
import sys
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate.saved_block import read_origin
from lostmotion.files import write_columns
from tests.e2e.test_gates import run

pytestmark = pytest.mark.statistics


def record(path, valve, noise=0.05, n=2500, seed=1):
    """Loop with set-point moves."""
    linear = lm.LinearModel.from_continuous([1.5], [12.0, 1.0], 2.0, 1.0)
    sp = np.repeat(50.0 + 4.0 * np.random.default_rng(seed).uniform(-1.0, 1.0, n // 100), 100)
    plant = lm.Hammerstein(valve, linear, 50.0 - 1.5 * 50.0)
    pi = lm.PI(1.5, 0.12, 0.0, 100.0, bias=50.0)
    level = plant.offset + linear.gain * 50.0 - plant.offset - linear.simulate(np.full(n, 50.0))
    loop = lm.simulate_loop(plant, pi, sp, disturbance=level, noise=noise**2, seed=seed)
    columns = {"time_s": loop.time, "SP": sp, "PV": loop.measured, "OP": loop.control}
    return write_columns(path, columns)


def test_from_a_record_to_a_block_and_its_code(capsys, tmp_path):
    file, out = record(tmp_path / "FIC-7.csv", lm.Backlash(2.0)), tmp_path / "block.json"
    code, text, error = run(capsys, "solve", file, "--out", out)
    assert (code, error) == (0, "")
    assert "A BLOCK came out" in text
    assert lm.read_block(out).kind == "backlash"
    assert not lm.read_block(out).accepted
    pasted = next(line for line in text.splitlines() if line.strip().startswith("lostmotion export"))
    words = shlex.split(pasted)[1:]
    code, _, _ = run(capsys, *words[:-1], tmp_path / "fy", "--replay", 300)
    assert code == 0
    page = next((tmp_path / "fy").glob("*_commissioning.md")).read_text(encoding="utf-8")
    origin = read_origin(out)
    assert "fingerprint" in origin["data"]
    assert "FIC-7" in origin["data"]
    assert all(said in page for said in (origin["fit"], "fingerprint"))
    assert "not given" not in page


def test_nothing_wrong_needs_no_block(capsys, tmp_path):
    code, text, _ = run(capsys, "solve", record(tmp_path / "FIC-8.csv", lm.Identity()), "--json")
    found = json.loads(text)
    assert found["outcome"] in ("nothing wrong", "closed")
    assert code == (0 if found["outcome"] == "nothing wrong" else 1)
    assert found["block"] is None


@pytest.mark.long
def test_what_is_printed_at_a_closed_gate_can_be_pasted(capsys, tmp_path, monkeypatch):
    def open_diagnosis(*given, **options):
        return replace(lm.diagnose(*given, **options), verdict="cannot tell")

    monkeypatch.setattr(sys.modules["lostmotion.evaluate.solve"], "diagnose", open_diagnosis)
    monkeypatch.chdir(tmp_path)
    code, text, _ = run(capsys, "solve", record(tmp_path / "FIC-9.csv", lm.Backlash(0.3), noise=0.4, n=600))
    assert code == 1
    first, second, *_ = [shlex.split(line)[1:] for line in text.splitlines() if line.strip().startswith("lostmotion ")]
    run(capsys, *first)
    assert (tmp_path / "FIC-9.fit.json").exists()
    code, said, error = run(capsys, *second)
    assert (code, error) == (0, "")
    assert "Test design" in said
    assert (tmp_path / "FIC-9.test.csv").exists()
