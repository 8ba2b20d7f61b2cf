"""identify on records: prepared by default, told in the report, equal to the arrays where nothing is wrong."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.records import prepare

SETTINGS = {"nonlinearity": "dead zone", "orders": (1, 0, 1), "noise": "white", "offset": "free"}
MODEL = lm.Hammerstein(lm.DeadZone(-0.7, 1.2, 2.0, 1.0), lm.LinearModel([-0.8], [0.3], 1), 3.0)
N = 400


def record(seed=4, noise=0.05, decimals=12, **settings):
    u = lm.signals.prs(N, -5, 5, 7, seed=seed)
    y = MODEL.simulate(u) + np.random.default_rng(seed).normal(scale=noise, size=N)
    return lm.LoopRecord(u, np.round(y, decimals), **({"dt": 1.0} | settings))


def test_notes_of_preparing_are_in_the_report():
    given = record()
    pv = given.pv.copy()
    pv[200:206] = np.nan
    fit = lm.identify(lm.LoopRecord(given.op, pv, dt=1.0), **SETTINGS)
    assert fit.data.segments.tolist() == [[0, 200], [200, 394]]
    assert "rows 201 to 206 (t = 200 to 205 s)" in " ".join(fit.summary().split())
    assert any("rows 201 to 206" in note for note in fit.to_dict()["data"]["notes"])


def test_prepared_records_are_taken_as_they_are():
    given = record()
    assert lm.identify(prepare(given), **SETTINGS).parameters == lm.identify(given, raw=True, **SETTINGS).parameters


def test_several_records_of_one_loop_with_one_refused():
    flat = lm.LoopRecord(np.full(N, 3.0), record().pv, dt=1.0, tag="second")
    fit = lm.identify([record(tag="first"), flat, record(5, tag="third")], **SETTINGS)
    assert fit.data.segments.tolist() == [[0, N], [N, 2 * N]]
    assert any(note.startswith("second (2): left out. expected OP that moves") for note in fit.data.notes)


@pytest.mark.statistics
def test_orders_given_ask_for_longer_pieces():
    given = record()
    pv = given.pv.copy()
    pv[90:96] = pv[180:186] = np.nan
    holed = lm.LoopRecord(given.op, pv, dt=1.0)
    assert lm.identify(holed, **SETTINGS).data.segments[0].tolist() == [0, 90]
    assert lm.identify(holed, orders=(1, 0, 25), noise="white", nonlinearity="dead zone").data.segments.tolist() == [
        [0, 214]
    ]


def test_step_of_pv_against_the_noise():
    assert not any("steps" in remark for remark in lm.identify(record(), **SETTINGS).remarks)
    felt = lm.identify(record(noise=0.08, decimals=1), **SETTINGS).remarks
    assert any("Rounding makes" in remark and "steps of 0.1" in remark for remark in felt)
    blind = lm.identify(record(noise=0.01, decimals=1), **SETTINGS).remarks
    assert any(remark.startswith("Beware: PV was stored in steps of 0.1") for remark in blind)


def test_few_levels_of_op_in_the_dead_zone():
    u = np.round(lm.signals.prs(N, -2, 2, 7, seed=4) * 2) / 2
    y = MODEL.simulate(u) + np.random.default_rng(1).normal(scale=0.02, size=N)
    fit = lm.identify(lm.LoopRecord(u, y, dt=1.0), **SETTINGS)
    assert any("steps of OP (0.5) wide" in remark for remark in fit.remarks)


@pytest.mark.statistics
def test_sampling_and_percent_of_span():
    slow = lm.Hammerstein(lm.DeadZone(-0.7, 1.2), lm.LinearModel([-0.985], [0.015], 1))
    u = lm.signals.prs(3000, -5, 5, 150, seed=2)
    y = slow.simulate(u) + np.random.default_rng(2).normal(scale=0.02, size=3000)
    fit = lm.identify(lm.LoopRecord(u, y, dt=1.0, op_span=(-10, 10), pv_span=(-20, 20)), **SETTINGS)
    assert any("sampling is fast" in remark and "resample by 6" in remark for remark in fit.remarks)
    moving = lm.LoopRecord(u + np.random.default_rng(3).normal(size=3000), fit.data.y, dt=1.0)
    assert not any("sampling is fast" in remark for remark in lm.identify(moving, **SETTINGS).remarks)
    percent = next(remark for remark in fit.remarks if remark.startswith("In % of the OP span"))
    assert "46.5 .. 56, width 9.48" in percent
    assert "gain 0.5 % of the PV span" in percent
    assert percent in " ".join(fit.summary().split())


@pytest.mark.statistics
def test_arrays_are_taken_as_they_are():
    given = record()
    pv = given.pv.copy()
    pv[100:140] = pv[100]
    assert lm.identify(given.op, pv, 1.0, **SETTINGS).data.segments.tolist() == [[0, N]]
    with pytest.raises(lm.DataError, match="row 7"):
        lm.identify(given.op, np.where(np.arange(N) == 7, np.nan, pv), 1.0, nonlinearity="dead zone")
