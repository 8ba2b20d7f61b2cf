"""Masks, times of samples and packing of the online service."""

import json

import numpy as np
import pytest

from lostmotion.errors import DataError, ParameterError
from lostmotion.files.grid import Rows
from lostmotion.online.masks import Masks
from lostmotion.online.packing import pack, unpack
from lostmotion.online.timeline import MOST_ANCHORS, Timeline
from tests.support.refusals import refusal


def rows(op, pv=None, automatic=None, time=None):
    op = np.asarray(op, dtype=float)
    pv = np.arange(op.size) * 1.0 if pv is None else np.asarray(pv, dtype=float)
    automatic = None if automatic is None else np.asarray(automatic)
    return Rows(np.arange(op.size) * 1.0 if time is None else np.asarray(time), op, pv, automatic)


def test_limits_of_op_have_a_margin():
    masks = Masks(op_limits=(0, 100))
    use = masks.use(rows([-1, 0, 0.5, 0.51, 50, 99.4, 99.5, 100, np.nan]))
    assert use.tolist() == [False, False, False, True, True, True, False, False, True]
    assert masks.counts == {"manual": 0, "saturated": 5, "frozen": 0}


def test_a_sample_counts_for_one_reason():
    masks = Masks(op_limits=(0, 100))
    assert masks.use(rows([0, 0, 50], automatic=[False, True, False])).tolist() == [False, False, False]
    assert masks.counts == {"manual": 2, "saturated": 1, "frozen": 0}


@pytest.mark.parametrize("cuts", [[], [1, 2, 3], [5], [6, 7], list(range(1, 14))])
def test_frozen_pv_however_it_is_cut(cuts):
    pv = np.array([1, 2, 2, 2, np.nan, 2, 2, 3, 3, 3, 4, np.nan, 4, 4])
    masks, found = Masks(frozen=3), []
    for part in np.split(np.arange(14), cuts):
        other = Masks(frozen=3)
        other.state = json.loads(json.dumps(masks.state, allow_nan=False))
        masks = other
        found += masks.use(rows(np.zeros(part.size), pv[part])).tolist()
    expected = [1, 1, 1, 0, 1, 0, 0, 1, 1, 0, 1, 1, 1, 0]
    assert found == [bool(value) for value in expected]
    assert masks.counts["frozen"] == 5


def test_masks_refuse():
    refusal(ParameterError, Masks, (100, 0))
    refusal(ParameterError, Masks, (0, np.inf))
    refusal(ParameterError, Masks, None, 1)


def test_timeline_through_gaps_and_new_clocks():
    line = Timeline(1.0)
    assert np.isnan(line.at(1))
    assert line.text(float("nan")) is None
    line.take(0, rows([0] * 3, time=[10.0, 11.0, 12.0]))
    line.take(3, rows([0] * 3, time=[500.0, 501.0, 502.0]))
    restarted = Rows(np.array([0.0, 1.0]), np.zeros(2), np.zeros(2), None, np.array([0]))
    line.take(6, restarted)
    assert [line.at(sample) for sample in (1, 3, 4, 6, 7, 8)] == [10, 12, 500, 502, 0, 1]
    assert (line.now, line.running, line.stamp(505.0)) == (1.0, 504.0, 2.0)
    other = Timeline(1.0)
    other.state = json.loads(json.dumps(line.state, allow_nan=False))
    assert other.state == line.state


def test_timeline_has_constant_memory_and_follows_a_drifting_clock():
    line = Timeline(1.0)
    for report in range(1000):
        line.take(10 * report, rows([0] * 10, time=1.001 * (10 * report + np.arange(10))))
        line.anchor(10 * (report + 1))
    assert len(line.state["anchors"]) == MOST_ANCHORS
    assert line.at(9950) == pytest.approx(1.001 * 9949, abs=0.02)


def test_dates_for_people():
    assert Timeline(1.0, "UTC").text(86_400.0) == "1970-01-02T00:00:00Z"
    assert Timeline(1.0).text(0.1 + 0.2) == 0.3


def test_packed_bytes_are_whole_or_refused():
    data = pack("a thing 1", {"x": [1, 0.1]}, b"\x00blob\n")
    assert unpack("a thing 1", data) == ({"x": [1, 0.1]}, b"\x00blob\n")
    for wrong in (b"", b"a thing 1\n", data[:-1], data[:20] + b"!" + data[21:], data + b"!"):
        refusal(DataError, unpack, "a thing 1", wrong)
    assert "a thing 2" in refusal(DataError, unpack, "a thing 2", data)
