"""Values of two signals -> rows: order, late and repeated values, clocks that are set, values that hold."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.live.joined import STEPPED, Joined
from lostmotion.live.loop_source import LoopSource, Signals, check_position
from lostmotion.live.value import Value

NODES = {"op": "ns=2;s=A.OP", "pv": "ns=2;s=A.PV"}


def values(role, pairs, at=0.0):
    return [Value(role, stamp, value, at) for stamp, value in pairs]


def rows(joined, now=1e9, **more):
    return [(row.stamp, row.held["op"], row.pv) for row in joined.take(10**6, now, **more)]


def scan(n, late=0.1):
    """PV each second, and OP a little later in the same scan."""
    pv = [Value("pv", float(k), 10.0 + k, 0.0) for k in range(n)]
    op = [Value("op", k + late, 100.0 + k, 0.0) for k in range(n)]
    return [one for pair in zip(pv, op, strict=True) for one in pair]


@settings(max_examples=60, deadline=None)
@given(st.lists(st.integers(1, 9), max_size=12), st.floats(-0.24, 0.24), st.randoms())
def test_rows_do_not_depend_on_the_pieces(cuts, late, random):
    signals = {"pv": [], "op": []}
    for one in scan(20, late):
        signals[one.role].append(one)
    mixed = []
    while signals["pv"] or signals["op"]:  # each signal in its order, the two in any
        role = random.choice([role for role, left in signals.items() if left])
        mixed.append(signals[role].pop(0))
    joined, found = Joined(1.0, patience=5.0), []
    for cut in [*cuts, 99]:
        joined.feed(mixed[:cut])
        found += rows(joined, now=1.0)
        mixed = mixed[cut:]
    found += rows(joined)
    assert found == [(float(k), 100.0 + k, 10.0 + k) for k in range(20)]


def test_a_row_waits_for_its_op_but_not_for_ever():
    joined = Joined(1.0, patience=0.6)
    joined.feed([Value("op", -5.0, 7.0, 0.0), Value("pv", 0.0, 1.0, 10.0)])
    assert rows(joined, now=10.5) == []
    assert rows(joined, now=10.7) == [(0.0, 7.0, 1.0)]
    joined.feed([Value("op", 0.1, 8.0, 11.0), Value("pv", 1.0, 2.0, 11.0)])
    assert joined.counts["behind"] == 1
    assert rows(joined, now=12.0) == [(1.0, 8.0, 2.0)]


def test_repeated_and_late_values_are_left_out_and_counted():
    joined = Joined(1.0, patience=0.0)
    joined.feed([*scan(5), *values("pv", [(4.0, 99.0), (2.0, 99.0)]), *values("op", [(4.1, 99.0), (1.0, 99.0)])])
    assert [row[2] for row in rows(joined)] == [10.0, 11.0, 12.0, 13.0, 14.0]
    assert (joined.counts["duplicates"], joined.counts["late"]) == (2, 2)


def test_values_that_come_again_at_once_are_no_step_of_the_clock():
    joined = Joined(1.0, patience=0.0)
    joined.feed(scan(20))
    joined.feed(scan(20))
    assert len(rows(joined)) == 20
    assert joined.counts["steps"] == 0


def test_a_clock_that_was_set_back_begins_a_new_recording():
    source = LoopSource(Signals("A", NODES, 1.0, 0.0), clock=lambda: 1e9)
    source.feed(scan(50))
    before = source.read(1000)
    back = [Value("pv", 30.0 + k, 500.0 + k, 100.0 + k) for k in range(STEPPED + 3)]
    ops = [Value("op", 30.0 + k, 700.0 + k, 100.0 + k) for k in range(STEPPED + 3)]
    source.feed([one for pair in zip(ops, back, strict=True) for one in pair])
    after = source.read(1000)
    assert len(before) == 50
    assert after.breaks.tolist() == [0]
    known = ~np.isnan(after.pv)
    assert after.pv[known].tolist() == [500.0 + k for k in range(STEPPED + 3)]
    assert after.op[known].tolist() == [700.0 + k for k in range(STEPPED + 3)]
    assert int((~known).sum()) == 1000  # no estimate reaches over it
    assert source.counts["steps"] == 1


def test_a_gap_is_missing_and_not_held():
    source = LoopSource(Signals("A", NODES, 1.0, 0.0), clock=lambda: 1e9)
    source.feed([one for one in scan(30) if not 10.0 <= one.stamp < 20.0])
    found = source.read(1000)
    assert len(found) == 30
    assert np.flatnonzero(np.isnan(found.pv)).tolist() == list(range(10, 20))
    assert np.isnan(found.op[10:20]).all()


def test_on_change_a_value_holds_while_the_link_is_alive():
    joined = Joined(1.0, patience=0.5, on_change=True)
    joined.feed([Value("op", 0.0, 5.0, 0.0), Value("pv", 0.0, 1.0, 0.0), Value("pv", 4.0, 2.0, 4.0)])
    assert rows(joined, now=5.0, alive=7.6) == [(k, 5.0, 1.0 if k < 4 else 2.0) for k in range(8)]
    joined.broken()
    joined.feed([Value("pv", 20.0, 3.0, 20.0)])
    assert rows(joined, now=30.0) == [(20.0, 5.0, 3.0)]


def test_rows_that_hold_are_not_counted_twice():
    joined = Joined(1.0, patience=0.5, on_change=True)
    joined.feed([Value("op", 0.0, 5.0, 0.0), Value("pv", 0.0, 1.0, 0.0)])
    found = [row[0] for now in np.arange(0.0, 20.0, 0.25) for row in rows(joined, now=now, alive=now)]
    assert found == [float(k) for k in range(len(found))]
    assert len(found) >= 19


def test_bad_values_are_missing_and_told():
    source = LoopSource(Signals("A", NODES, 1.0, 0.0), clock=lambda: 1e9)
    bad = [one._replace(value=math.nan, why="BadSensorFailure") if one.stamp in (3.0, 4.0) else one for one in scan(8)]
    source.feed(bad)
    found = source.read(1000)
    assert np.flatnonzero(np.isnan(found.pv)).tolist() == [3, 4]
    assert [note.text.split(": ", 1)[1] for note in found.notes] == [
        "PV is BadSensorFailure: missing until it is good.",
        "PV is good again.",
    ]
    assert source.counts["bad"] == 2


@pytest.mark.parametrize("cut", [1, 7, 19])
def test_going_on_from_a_position_gives_each_row_once(cut):
    source = LoopSource(Signals("A", NODES, 1.0, 0.0), clock=lambda: 1e9)
    source.feed([one for one in scan(30) if one.stamp < cut])
    first = source.read(1000)
    position = json.loads(json.dumps(source.position))
    assert check_position(position) == 1.0
    again = LoopSource(Signals("A", NODES, 1.0, 0.0), position, clock=lambda: 1e9)
    again.feed(scan(30))  # the server tells all of it once more
    second = again.read(1000)
    assert [*first.pv, *second.pv] == [10.0 + k for k in range(30)]
    assert [*first.op, *second.op] == [100.0 + k for k in range(30)]


def test_a_position_of_another_node_is_refused():
    source = LoopSource(Signals("A", NODES, 1.0, 0.0))
    with pytest.raises(ValueError, match="as before"):
        LoopSource(Signals("A", {**NODES, "pv": "ns=2;s=B.PV"}, 1.0, 0.0), source.position)
