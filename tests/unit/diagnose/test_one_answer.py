"""One record has one answer, whichever way it is asked for."""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest
from typer.testing import CliRunner

import lostmotion as lm
from lostmotion.cli import app
from lostmotion.errors import ParameterError
from lostmotion.evaluate import random_faulty_loop

NUMBERS = ("verdict", "kind", "severity", "size", "size_percent", "confidence", "probabilities", "excluded", "why")


@cache
def loop(cause="stiction", seed=4, samples=1200):
    made = random_faulty_loop(seed, samples=samples, cause=cause, process="flow")
    return lm.LoopRecord(made.op, made.pv, made.sp, dt=1.0, tag="FIC-4")


def same(one, other):
    for name in NUMBERS:
        np.testing.assert_equal(getattr(one, name), getattr(other, name), err_msg=name)
    np.testing.assert_equal(one.interval, other.interval)
    assert one.fingerprint == other.fingerprint


def test_a_list_of_one_record_is_that_record():
    alone, listed = lm.diagnose(loop()), lm.diagnose([loop()], starts=[0.0])
    same(alone, listed)
    assert listed.summary() == alone.summary()
    with pytest.raises(ParameterError, match="1 start times, got 2"):
        lm.diagnose([loop()], starts=[0.0, 1.0])


def test_identify_takes_a_list_of_one_as_the_record():
    alone, listed = lm.identify(loop()), lm.identify([loop()])
    assert listed.to_dict() == alone.to_dict()
    assert listed.summary() == alone.summary()


def test_the_only_usable_record_answers_alone():
    still = lm.LoopRecord(np.full(300, 50.0), np.arange(300.0), dt=1.0, tag="still")
    alone, pooled = lm.diagnose(loop()), lm.diagnose([still, loop(), loop()])
    for name in NUMBERS:
        np.testing.assert_equal(getattr(alone, name), getattr(pooled, name), err_msg=name)
    assert pooled.interval == alone.interval
    assert pooled.single == "FIC-4"
    assert [share.said for share in pooled.shares] == ["left out", "for", "left out"]
    text = " ".join(pooled.summary().split())
    assert "still: expected OP that moves, got the constant 50" in text
    assert "1200 rows are in an earlier record as well" in text
    assert pooled.to_dict()["pooled"]["records"][0]["said"] == "left out"


def test_one_interval_of_the_size_in_every_report():
    fit, found = lm.identify(loop()), lm.diagnose(loop())
    low, high = fit.size_interval
    assert (low, high) == found.interval == found.fit.size_interval == fit.facts.size_interval
    assert low < fit.interval("band")[0]
    assert high > fit.interval("band")[1]
    assert fit.to_dict()["size_interval_95"] == found.to_dict()["interval_95"] == [low, high]
    shown = f"band 2.23 +/- {(high - low) / 3.92:.2f}, 95 % interval {low:.2f} .. {high:.2f}"
    assert shown in " ".join(fit.summary().split())
    assert f"{low:.2f} .. {high:.2f}" in " ".join(found.summary().split())
    assert "statistical" in fit.summary()
    assert shown.replace("interval ", "") in fit.facts.summary()


def test_same_loop_of_one_file_is_the_file(tmp_path):
    file = tmp_path / "FIC-4.csv"
    write(file)
    said = [
        json.loads(CliRunner().invoke(app, ["diagnose", str(file), *more, "--json"]).stdout)
        for more in ([], ["--same-loop"])
    ]
    for name in (*NUMBERS, "interval_95", "fingerprint"):
        assert said[0][name] == said[1][name], name
    assert said[0]["fingerprint"] == lm.read_loop(file).fingerprint == said[0]["fit"]["data"]["fingerprint"]


def write(file):
    record = loop()
    rows = [
        f"{k},{sp!r},{pv!r},{op!r}"
        for k, (sp, pv, op) in enumerate(zip(record.sp.tolist(), record.pv.tolist(), record.op.tolist(), strict=True))
    ]
    file.write_text("\n".join(["Time (s),SP,PV,OP", *rows]))
