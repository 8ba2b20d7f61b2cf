"""The published tables of the paper (ICINCO 2010), with few seeds; `lostmotion paper` runs many."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.paper import study_control, study_estimation, to_dict, write_page
from lostmotion.paper.published import TABLE_1, TABLE_2

pytestmark = pytest.mark.statistics


@pytest.fixture(scope="module")
def control():
    return study_control(seeds=40)


@pytest.fixture(scope="module")
def estimation():
    return study_estimation(seeds=6, samples=20_000, processes=1)


def test_discretisation_is_equation_30():
    tank = lm.platforms.level_tank().linear
    for name, value in zip(("a1", "a2", "a3"), tank.a, strict=True):
        assert value == pytest.approx(TABLE_1[name][1], abs=6e-4)
    for name, value in zip(("b0", "b1", "b2"), tank.b, strict=True):
        assert value == pytest.approx(TABLE_1[name][1], abs=1e-5)


@pytest.mark.parametrize("track", [1, 2, 3])
@pytest.mark.parametrize("case", ["without", "with"])
def test_table_2_eps2(control, track, case):
    """Within 5 % of the published single run, or within 2 of the spreads from one noise sequence to the next."""
    mean, spread = control.mean(case, track)[1], control.spread(case, track)[1]
    published = TABLE_2[track][case][1]
    assert abs(mean - published) < max(0.05 * published, 2 * spread)
    assert abs(mean - published) < 0.10 * published


def test_table_2_eps1_of_track_1(control):
    for case in ("without", "with"):
        assert control.mean(case, 1)[0] == pytest.approx(TABLE_2[1][case][0], rel=0.10)


def test_compensation_lowers_both_indices_on_all_tracks(control):
    for track in TABLE_2:
        for index in (0, 1):
            assert control.mean("with", track)[index] < control.mean("without", track)[index]


def test_compensated_loop_is_as_good_as_one_without_dead_zone(control):
    assert control.iae("with") == pytest.approx(control.iae("ideal"), rel=0.02)


def test_limit_cycles_only_without_compensation(control):
    for track in (2, 3):
        assert control.limit_cycle["without", track] > 0.4
        assert control.limit_cycle["with", track] < 0.01
        assert control.limit_cycle["ideal", track] < 0.01


def test_level_swings_as_figure_11_shows(control):
    loop = control.responses["without"]
    during = loop.output[150:400] + 50
    assert 43.5 < during.min() < 46.5
    assert 53.5 < during.max() < 56.5


def test_every_method_runs_and_the_bias_of_least_squares_shows(estimation):
    for method in ("riv", "rls", "els", "voros", "ml"):
        assert estimation.summary(method)["converged"] >= 5
    found = estimation.summary("rls")
    assert abs(found["mean"]["right_slope"] - 3) > 3 * found["standard_error"]["right_slope"]
    for name in ("left", "right"):
        assert estimation.spread("riv", name)[2] > 10 * estimation.spread("ml", name)[2]


def test_page_and_json(estimation, control):
    page = write_page(estimation, control)
    assert page.count("<img") == 3
    assert "Errata" in page
    assert "2.4786" in page
    data = json.loads(json.dumps(to_dict(estimation, control), allow_nan=False))
    assert data["table_1"]["published"]["right"] == [1.0214, 1.0]
    assert np.isclose(data["table_2"]["with 2"]["mean"][1], control.mean("with", 2)[1])
