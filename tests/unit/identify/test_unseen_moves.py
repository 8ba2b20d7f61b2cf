"""A controller that acts between the rows of its record is told from one that acts in every row."""

import importlib
import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identify.data import collect
from lostmotion.identify.recording import Recording
from lostmotion.identify.unseen_moves import Unseen, beyond_unseen, may_be_settled, unseen_moves, within_unseen
from tests.support.fits import made_fit

GAIN, INTEGRAL = 0.8, 0.05  # of the controller, at each of its scans


def loop(scans, *, band=0.0, rows=1500, noise=0.1, seed=1, sp_known=True, before=0.0, after=0.0, by_hand=False):
    """Record of which every row has so many scans of a PI; PV is rounded `before` the controller or `after` it."""
    random = np.random.default_rng(seed)
    n = rows * scans
    sp = np.repeat(random.uniform(-3.0, 3.0, rows // 100 + 1), 100 * scans)[:n]
    op, pv = np.zeros(n), np.zeros(n)
    valve = state = 0.0
    integral = 0.0
    for k in range(n):
        state += (0.1 / scans) * (valve - state)
        pv[k] = state + noise * random.standard_normal()
        if before:
            pv[k] = before * np.round(pv[k] / before)
        integral += INTEGRAL / scans * (sp[k] - pv[k])
        op[k] = 2.0 * np.sign(np.sin(k / (40.0 * scans))) if by_hand else GAIN * (sp[k] - pv[k]) + integral
        valve = min(max(valve, op[k] - band / 2), op[k] + band / 2)
    if after:
        pv, op = after * np.round(pv / after), after * np.round(op / after)
    at = slice(None, None, scans)
    return lm.LoopRecord(50 + op[at], 50 + pv[at], 50 + sp[at] if sp_known else None, dt=1.0, op_span=(0.0, 100.0))


def moves(record):
    return unseen_moves(collect(record, None, None)).moves


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("scans", [2, 4, 8])
def test_noise_of_op_is_found_where_scans_are_unseen(scans, seed):
    """OP has the noise of PV times the gain; seven past rows do not quite foretell the rest."""
    assert 1.0 < moves(loop(scans, seed=seed)) / (GAIN * 0.1) < 1.4


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    "options", [{}, {"after": 0.01}, {"after": 0.05}, {"before": 0.05}, {"sp_known": False}, {"band": 1.0}]
)
def test_a_controller_that_acts_once_a_row_has_no_unseen_moves(options, seed):
    assert moves(loop(1, seed=seed, **options)) == 0.0


@pytest.mark.parametrize("scans", [1, 4])
def test_rounding_leaves_open_whether_there_are_scans_between_the_rows(scans):
    found = unseen_moves(collect(loop(scans, after=0.1), None, None))
    assert found.moves == 0.0
    assert found.about(sticks=True) == found.perhaps > 0.03
    assert found.about(sticks=False) == 0.0
    assert found.doubted(1.0, found.perhaps, sticks=True) == pytest.approx(1.0 - 2.0 * found.perhaps)
    assert "do not tell whether" in found.words(found.perhaps)


def test_a_dead_zone_is_filled_by_what_the_rows_do_not_explain():
    assert Unseen(moves=1.0, rest=0.2).about(sticks=False) == 1.0
    assert Unseen(moves=1.0, rest=0.01).about(sticks=False) == pytest.approx(0.2)
    assert beyond_unseen(5.0, 1.0, sticks=False) == 6.0
    assert within_unseen(5.0, 1.0, sticks=False) == 5.0
    assert Unseen(moves=1.0, rest=0.2).doubted(5.0, 1.0, sticks=True) == 5.0  # known to be there


@pytest.mark.parametrize("options", [{"before": 0.05}, {"sp_known": False}, {"band": 1.0}])
def test_what_else_is_in_the_record_does_not_hide_the_scans(options):
    assert moves(loop(4, **options)) > 0.03


def test_nothing_is_said_of_moves_by_hand_nor_of_too_few_rows():
    assert moves(loop(4, by_hand=True)) == 0.0
    assert moves(loop(4, rows=80)) == 0.0


def test_arrays_and_op_that_something_else_moves_tell_nothing():
    random = np.random.default_rng(4)
    u, y = random.standard_normal((2, 500))
    assert unseen_moves(collect(u, y, 1.0)).moves == 0.0


def test_the_interval_of_a_size_is_wider_by_them(tmp_path):
    for kind, size in (("backlash", "width"), ("stiction", "band")):
        plain = made_fit(kind)
        moved = replace(plain, evidence=replace(plain.evidence, unseen_moves=0.25))
        low, high = plain.interval(size)
        expected = within_unseen(low, 0.25), beyond_unseen(high, 0.25)
        assert moved.interval(size) == expected
        assert expected[0] < low < high < expected[1]
        assert any("OP moves by about 0.25 between the rows" in remark for remark in moved.remarks)
        assert not any("between the rows" in remark for remark in plain.remarks)
        assert lm.read_fit(moved.save(tmp_path / f"{kind}.json")).interval(size) == pytest.approx(expected)
        if kind == "stiction":
            assert moved.interval("jump") == plain.interval("jump")
    assert within_unseen(0.2, 0.5) == 0.0
    assert within_unseen(-0.2, 0.0) == -0.2  # left as it is


def test_moves_that_hardly_widen_a_dead_zone_are_not_told():
    plain = made_fit("dead zone")
    width = plain.parameters["width"]
    assert width > 0.0
    for share, told in ((0.01, False), (0.2, True)):
        moved = replace(plain, evidence=replace(plain.evidence, unseen_moves=share * width))
        assert any("between the rows" in remark for remark in moved.remarks) is told
    hidden = replace(moved, status=lm.Status.OTHER_KIND)
    assert not any("between the rows" in remark for remark in hidden.remarks)


def test_a_saved_fit_has_none_below_zero(tmp_path):
    saved = made_fit("backlash").to_dict()
    saved["evidence"]["unseen_moves"] = -0.1
    path = tmp_path / "fit.json"
    path.write_text(json.dumps(saved))
    with pytest.raises(lm.DataError, match="unseen_moves"):
        lm.read_fit(path)


@pytest.mark.statistics
def test_the_width_is_in_the_interval_of_most_loops_with_unseen_scans():
    held = bounds = 0
    for seed in range(8):
        fit = lm.identify(loop(4, band=2.0, seed=seed), nonlinearity="backlash")
        assert fit.evidence.unseen_moves > 0.0
        low, high = fit.interval("width")
        held += low <= 2.0 <= high
        plain = replace(fit, evidence=replace(fit.evidence, unseen_moves=0.0)).interval("width")
        bounds += plain[0] <= 2.0 <= plain[1]
    assert held >= 7
    assert held > bounds


@pytest.mark.statistics
def test_no_size_is_excluded_that_unseen_scans_hide(monkeypatch):
    record = loop(4)
    found, unseen = lm.diagnose(record).excluded, unseen_moves(collect(record, None, None))
    more = {"dead zone": unseen.about(sticks=False)} | dict.fromkeys(["backlash", "stiction"], 2.0 * unseen.moves)
    alone = lm.identify(record, nonlinearity="backlash")
    assert alone.status is lm.Status.NOT_SEEN
    monkeypatch.setattr(importlib.import_module("lostmotion.identify.data"), "unseen_moves", lambda _: Unseen())
    plain = lm.identify(record, nonlinearity="auto").kinds.excluded
    assert 0.0 < more["dead zone"] < more["backlash"]
    for name, size in found.items():
        assert size == pytest.approx(plain[name] + more[name])
    assert alone.widest == pytest.approx(lm.identify(record, nonlinearity="backlash").widest + more["backlash"])
    assert alone.interval("width") == (0.0, alone.widest)


@pytest.mark.parametrize(
    ("a", "b", "settles"), [([0.2], [0.9], True), ([-0.9], [0.05], False), ([], [0.0, 1.0], False)]
)
def test_few_moves_of_sp_leave_open_whether_a_fast_loop_settles_between_the_rows(a, b, settles):
    assert may_be_settled(SimpleNamespace(unseen=Unseen(untold=True)), np.array(a), np.array(b)) == settles
    assert not may_be_settled(SimpleNamespace(unseen=Unseen()), np.array(a), np.array(b))


def fast_flow(seed, *, band=4.0, rows=2000, scans=10):
    """A flow at rest of which a row falls between two scans of its PI: noise of PV is new at each, and in the row."""
    random = np.random.default_rng(seed)
    n = rows * scans
    drift, fast = random.normal(size=(2, n))
    noise = 0.5 * random.normal(size=n)
    op, pv = np.zeros(n), np.zeros(n)
    valve = behind = state = integral = slow = quick = 0.0
    for k in range(n):
        slow += -slow / 7200 + 6.0 * np.sqrt(2 / 7200) * drift[k]
        quick += -quick / 20 + 1.5 * np.sqrt(2 / 20) * fast[k]
        behind += 0.4 * (valve - behind)
        state += 0.2 * (1.1 * behind + slow + quick - state)
        pv[k] = state + 0.5 * random.normal()
        integral -= 0.08 * (state + noise[k])
        op[k] = integral - 0.35 * (state + noise[k])
        valve = min(max(valve, op[k] - band / 2), op[k] + band / 2)
    at = slice(None, None, scans)
    return lm.LoopRecord(50 + op[at], 50 + pv[at], np.full(rows, 50.0), dt=5.0, op_span=(0.0, 100.0))


def test_where_nothing_tells_what_moves_op_its_noise_counts_for_a_size_and_for_no_exclusion():
    found = unseen_moves(collect(fast_flow(1), None, None))
    assert found.untold
    assert found.moves == found.about(sticks=True) == 0.0
    assert found.of_size(sticks=True, closed=True) == found.possible > 0.5
    assert found.of_size(sticks=True, closed=False) == found.of_size(sticks=False, closed=True) == 0.0
    assert found.doubted(5.0, found.possible, sticks=True) == pytest.approx(5.0 - 2.0 * found.possible)
    assert "is in no row" in found.words(found.possible)


def test_rounding_in_what_its_own_past_foretells_of_op_is_no_move():
    t = np.arange(1500)
    swing = lm.LoopRecord(50 + np.sin(0.2 * t), 50 + np.cos(0.2 * t), np.full(t.size, 50.0), dt=1.0)
    assert unseen_moves(collect(swing, None, None)) == Unseen()


@pytest.mark.parametrize("known", [True, False])
def test_the_least_size_that_is_known_does_not_count_moves_that_may_not_be(known):
    plain = made_fit("backlash")
    unseen = Unseen(moves=1.5) if known else Unseen(untold=True, possible=1.5)
    data = replace(plain.data, recording=Recording(unseen, plain.data.foretold))
    fit = replace(plain, evidence=replace(plain.evidence, unseen_moves=1.5), data=data)
    least, seen = fit.interval("width")[0], plain.interval("width")[0]
    assert least == within_unseen(seen, 1.5) < seen
    assert fit.least_known == (least if known else seen)


@pytest.mark.statistics
def test_the_width_is_in_the_interval_of_a_flow_whose_set_point_rests():
    """It seems half as wide; the rows do not tell that OP goes further between them."""
    for seed in (1, 3, 5, 7):
        fit = lm.identify(fast_flow(seed), nonlinearity="backlash", integrating=False)
        plain = replace(fit, evidence=replace(fit.evidence, unseen_moves=0.0))
        assert plain.interval("width")[1] < 4.0 < fit.interval("width")[1]
        assert fit.interval("width")[0] > 0.0
