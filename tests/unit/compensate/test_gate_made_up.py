"""No block from a record that a historian drew, nor from a model that misfits."""

import importlib
import json
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.compensate.gate import closed
from lostmotion.errors import DataError, GateError, Status
from lostmotion.evaluate import random_faulty_loop
from lostmotion.export import export
from lostmotion.records import prepare
from lostmotion.records.compression import Compression, MadeUp, made_up
from tests.support.diagnoses import example
from tests.support.fits import made_fit
from tests.support.refusals import refusal

WHY = "the same size was seen on the bench, J. Doe"
NAMED = {"name": "FY_101", "date": "2026-01-31"}


def drawn(op=(0.0, 0.0), pv=(0.0, 0.0), *, kind="backlash", status=Status.OK, closed_loop=True):
    """Fit to a record of which these shares are on lines, and held."""
    fit = made_fit(kind, status, closed_loop=closed_loop)
    return replace(fit, data=replace(fit.data, made_up=MadeUp(Compression(*op), Compression(*pv))))


@pytest.mark.parametrize("kind", ["backlash", "stiction", "dead zone"])
@pytest.mark.parametrize(
    ("op", "pv", "words"),
    [
        ((0.0, 0.0), (0.31, 0.0), "31 % of the rows of PV on straight lines"),
        ((0.31, 0.0), (0.0, 0.0), "31 % of the rows of OP on straight lines"),
        ((0.0, 0.0), (0.1, 0.51), "61 % of the rows of PV made up"),
    ],
)
def test_what_a_historian_made_up_is_no_ground_for_a_block(tmp_path, kind, op, pv, words):
    fit = drawn(op, pv, kind=kind)
    for form in (fit, fit.facts, lm.read_fit(fit.save(tmp_path / "fit.json"))):
        said = refusal(GateError, form.block)
        assert words in said
        assert "export raw values" in said
        assert "accept='<reason>'" in said
        assert words in form.block(accept=WHY).accepted
    made = made_fit(kind).block()
    assert words in refusal(GateError, export, made, "st", **NAMED, fit=fit)
    assert words in refusal(GateError, lm.compensation_study, fit, lm.PI(1.0, 0.1))


@pytest.mark.parametrize(("op", "pv"), [((0.29, 0.0), (0.29, 0.0)), ((0.0, 0.0), (0.0, 0.59))])
def test_less_than_that_is(op, pv):
    assert closed(drawn(op, pv).facts) is None


def test_a_ramp_by_hand_is_no_line_of_a_historian():
    assert closed(drawn(op=(0.8, 0.0), closed_loop=False).facts) is None


def test_a_test_or_a_watch_uses_no_size():
    assert closed(drawn(pv=(0.8, 0.0)).facts, sized=False) is None


def test_the_kind_is_asked_for_first():
    assert "OTHER_KIND" not in refusal(GateError, drawn(pv=(0.8, 0.0), status=Status.MISFIT).block)
    assert "NOT_SEEN" in refusal(GateError, drawn(pv=(0.8, 0.0), status=Status.NOT_SEEN).block)


def test_a_model_that_misfits_has_no_size():
    assert "MISFIT" in refusal(GateError, made_fit("backlash", Status.MISFIT).block)


def test_the_shares_are_saved_and_an_older_file_has_none(tmp_path):
    fit = drawn((0.2, 0.0), (0.4, 0.1))
    assert lm.read_fit(fit.save(tmp_path / "fit.json")).made_up == fit.data.made_up
    saved = json.loads(json.dumps(fit.to_dict()))
    del saved["data"]["made_up"]
    older = lm.FitFacts.from_dict(saved)
    assert older.made_up is None
    assert closed(older) is None
    assert made_fit("backlash").facts.made_up is None


@pytest.mark.parametrize(
    "wrong", [3, "0.3", {}, {"op": 0.3, "pv": 0.3}, {"pv": {"straight": 0.1, "held": 0.0}}, [[0.1, 0.2]]]
)
def test_damaged_shares_are_refused(wrong):
    saved = drawn().to_dict()
    saved["data"] = saved["data"] | {"made_up": wrong}
    assert "made_up" in refusal(DataError, lm.FitFacts.from_dict, saved)


@pytest.mark.parametrize("share", [-0.1, 1.1, None, "much", True])
def test_a_share_is_one(share):
    saved = json.loads(json.dumps(drawn().to_dict()))
    saved["data"]["made_up"]["pv"]["straight"] = share
    assert "made_up" in refusal(DataError, lm.FitFacts.from_dict, saved)


def test_solve_stops_there_too(monkeypatch):
    found = replace(example(), verdict="backlash", fit=drawn(pv=(0.8, 0.0)))
    monkeypatch.setattr(importlib.import_module("lostmotion.evaluate.solve"), "diagnose", lambda *_, **__: found)
    row = np.arange(400.0)
    way = lm.solve(lm.LoopRecord(50.0 + np.sin(row / 9), np.cos(row / 9), dt=0.5))
    assert (way.outcome, way.closed.name) == ("closed", "identify")
    assert "straight lines" in way.closed.said
    assert "export raw values" in way.closed.remedy


# From a record


def door(values, band):
    """The archive of a swinging door: stored where it has moved by more than the band, lines between; shape (n,)."""
    stored = [0]
    for row in range(1, len(values)):
        if abs(values[row] - values[stored[-1]]) > band:
            stored.append(row)
    return np.interp(np.arange(len(values)), stored, values[stored])


@pytest.fixture(scope="module")
def healthy():
    """Record of a healthy valve behind a historian that draws PV in lines over twice its noise."""
    made = random_faulty_loop(1, cause="none")
    noise = float(np.median(np.abs(np.diff(made.pv)))) / 0.954
    return lm.LoopRecord(made.op, door(made.pv, 2.0 * noise), made.sp, dt=made.dt, op_span=(0.0, 100.0))


@pytest.mark.statistics
def test_a_healthy_valve_behind_a_historian_gets_no_block(healthy):
    fit = lm.identify(healthy, nonlinearity="auto")
    assert fit.preferred == "stiction"  # lines foretell the next value: it seems to stick
    assert "straight lines" in refusal(GateError, fit.block)


@pytest.mark.statistics
def test_every_way_into_a_fit_counts_them(healthy):
    seen = made_up(healthy)
    assert seen.pv.straight > 0.7
    assert prepare(healthy).made_up == seen
    ways = {
        "record": lm.identify(healthy, nonlinearity="none"),
        "raw": lm.identify(healthy, nonlinearity="none", raw=True),
        "arrays": lm.identify(healthy.op, healthy.pv, dt=healthy.dt, nonlinearity="none"),
        "twice": lm.identify([healthy, healthy], nonlinearity="none"),
    }
    for name, fit in ways.items():
        assert fit.facts.made_up.pv.straight == pytest.approx(seen.pv.straight, rel=1e-9), name


def test_rows_that_the_reader_made_up_count_for_pv_only():
    op, pv = np.random.default_rng(0).normal(size=(2, 300))
    seen = made_up(lm.LoopRecord(op, pv, dt=1.0, made_up=(0.8, 0.5)))
    assert seen == MadeUp(Compression(0.0, 0.0), Compression(0.5, 0.0))


@pytest.mark.statistics
@pytest.mark.parametrize(
    ("pv", "verdict", "told"),
    [
        ((0.29, 0.0), "stiction", True),
        ((0.31, 0.0), "stiction", False),
        ((0.1, 0.51), "stiction", False),
        ((0.79, 0.0), "stiction", False),
        ((0.81, 0.0), "cannot tell", False),
        ((0.0, 0.81), "cannot tell", False),
    ],
)
def test_a_diagnosis_gives_no_size_either(monkeypatch, pv, verdict, told):
    """The fit is of a record as it was measured; only what is known of its rows is changed."""
    module = importlib.import_module("lostmotion.diagnose.one_record")
    loop = random_faulty_loop(4, cause="stiction", process="flow")
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0, op_span=(0.0, 100.0))
    fit = lm.identify(record, nonlinearity="auto")
    seen = MadeUp(Compression(0.0, 0.0), Compression(*pv))
    monkeypatch.setattr(
        module, "identify_for_verdict", lambda *_, **__: replace(fit, data=replace(fit.data, made_up=seen))
    )
    found = lm.diagnose(record)
    assert found.verdict == verdict
    assert np.isfinite([found.size, *found.interval]).all() == told
    if verdict == "cannot tell":
        assert "81 % of the rows of PV are a historian's" in found.why
        assert "raw values" in " ".join(found.advice)
    else:
        assert (found.severity == "unknown") != told
        assert any("does not tell" in note for note in found.notes) != told
