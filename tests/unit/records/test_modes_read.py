"""Modes as plants write them: what means nothing here is unknown, and --auto-value says what it means."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.one_record import _manual
from lostmotion.records.modes import rows_of, unknown_words
from tests.e2e.test_commands import run


@pytest.fixture
def path(tmp_path):
    k = np.arange(400)
    path = tmp_path / "FIC-1.csv"
    rows = [f"{n},{50 + 5 * np.sin(n / 9):.3f},{np.cos(n / 9):.3f},0,{1 if n < 300 else 0}" for n in k]
    path.write_text("\n".join(["time_s,OP,PV,SP,mode", *rows, ""]))
    return path


def test_a_mode_that_means_nothing_here_is_unknown(path):
    record = lm.read_loop(path)
    assert rows_of("automatic", record.mode) is None
    assert _manual(record) == 0.0
    assert _manual(lm.read_loop(path, automatic="1")) == pytest.approx(0.25)
    np.testing.assert_array_equal(
        rows_of("manual", lm.read_loop(path, automatic=["1"], manual="0").mode), np.arange(400) >= 300
    )


def test_options_say_what_the_modes_mean(capsys, path):
    code, text, _ = run(capsys, "check", path, "--auto-value", 1, "--manual-value", 0, "--json")
    assert code == 0
    assert "Manual in 100 rows" in text
    assert "not known here" not in text
    assert json.loads(text)["usable"]
    said = run(capsys, "check", path)[1]
    assert "--auto-value" in said
    assert said.splitlines()[0].startswith(
        "FIC-1.csv holds loop 'FIC-1', a flow loop by its tag: 400 samples of OP, PV"
    )
    assert said.splitlines()[-1] == f"Next: lostmotion diagnose {path}"


@pytest.mark.parametrize(
    ("automatic", "manual", "detached"),
    [
        ("AUTO", "Man", "O/S"),
        ("Cas", "Manual", "Local"),
        ("Automatik", "Hand", "Außer Betrieb"),
        ("Automatisch", "Handbetrieb", "Nachführen"),
        ("Kaskade", "H", "Vor Ort"),
        ("Automatique", "Manuel", "Hors service"),
        ("Cascade", "MANUEL", "arrêt"),
        ("Automático", "Manual", "Fuera de servicio"),
        ("Cascada", "mano", "Seguimiento"),
        ("AUTOMATICO", "manual", "Fora de serviço"),
        ("Cascata", "Manual", "Desligado"),
    ],
)
def test_modes_in_the_languages_of_the_headers(tmp_path, automatic, manual, detached):
    k = np.arange(400)
    words = np.where(k < 300, automatic, np.where(k < 380, manual, detached))
    path = tmp_path / "FIC-1.csv"
    rows = [f"{n};{50 + 5 * np.sin(n / 9):.3f};{np.cos(n / 9):.3f};{word}" for n, word in zip(k, words, strict=True)]
    path.write_text("\n".join(["Zeit [s];Stellgröße;Istwert;Betriebsart", *rows, ""]).replace(".", ","), "latin-1")
    record = lm.read_loop(path)
    assert unknown_words(record.mode) == []
    for kind, part in (("automatic", k < 300), ("manual", (k >= 300) & (k < 380)), ("detached", k >= 380)):
        np.testing.assert_array_equal(rows_of(kind, record.mode), part)
