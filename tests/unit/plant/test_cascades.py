"""Masters and slaves, told from OP and SP."""

from datetime import UTC, datetime

import numpy as np
import pytest

from lostmotion.plant import loop_list_text, open_plant, parse_loop_list, propose
from lostmotion.plant.cascades import Cascades
from lostmotion.records import LoopRecord

N, DT = 6000, 5.0
START = datetime(2026, 3, 10, tzinfo=UTC)


def walk(seed):
    return 50.0 + np.cumsum(np.random.default_rng(seed).normal(size=N))


def record(op, sp=None, start=START, **more):
    return LoopRecord(op, walk(99), sp=sp, dt=DT, start=start, **more)


def slaves(**records):
    seen = Cascades()
    for tag, one in records.items():
        seen.add(tag, one)
    return seen.slaves()


def test_a_master_is_told_by_the_set_point_of_its_slave_in_other_units():
    master = walk(1)
    found = slaves(LIC1=record(master), FIC2=record(walk(2), 0.4 * master + 3.0), FIC3=record(walk(3), walk(4)))
    assert found == {"LIC1": "FIC2"}
    assert slaves(FIC2=record(walk(2), -0.4 * master), LIC1=record(master)) == {"LIC1": "FIC2"}, "acts the other way"


def test_a_set_point_that_was_written_late_or_rounded_is_one_still():
    master = walk(1)
    late = np.round(np.r_[master[:2], master[:-2]], 1) + 0.3 * np.random.default_rng(3).normal(size=N)
    assert slaves(LIC1=record(master), FIC2=record(walk(2), late)) == {"LIC1": "FIC2"}


def test_a_slave_that_is_in_automatic_for_a_while_is_one_still():
    master = walk(1)
    held = np.where(np.arange(N) < N // 3, master[N // 3], master)
    assert slaves(LIC1=record(master), FIC2=record(walk(2), held)) == {"LIC1": "FIC2"}


@pytest.mark.parametrize("steps", [1, 3, 12])
def test_steps_of_an_operator_are_no_cascade(steps):
    """One step is like any other."""
    places = np.linspace(0, N, steps + 2).astype(int)[1:-1]
    sp = np.cumsum(np.isin(np.arange(N), places))
    assert slaves(LIC1=record(walk(1) + 40.0 * sp), FIC2=record(walk(2), sp.astype(float))) == {}


def test_what_only_drifts_alike_is_no_cascade():
    drift = np.linspace(0.0, 500.0, N)
    assert slaves(LIC1=record(walk(1) + drift), FIC2=record(walk(2), walk(3) + drift)) == {}


def test_a_loop_is_not_its_own_slave_and_other_hours_are_not_compared():
    master = walk(1)
    later = datetime(2026, 3, 20, tzinfo=UTC)
    assert slaves(FIC2=record(master, master)) == {}
    assert slaves(LIC1=record(master), FIC2=record(walk(2), master, start=later)) == {}


def test_of_two_slaves_the_one_that_is_more_alike():
    master = walk(1)
    noise = np.random.default_rng(5).normal(size=N)
    found = slaves(LIC1=record(master), FIC2=record(walk(2), master + 2.0 * noise), FIC3=record(walk(3), master))
    assert found == {"LIC1": "FIC3"}


def test_gaps_and_missing_values_do_no_harm():
    master, missing = walk(1), walk(1)
    missing[1000:1400] = np.nan
    assert slaves(LIC1=record(missing), FIC2=record(walk(2), master)) == {"LIC1": "FIC2"}
    assert slaves(LIC1=record(np.full(N, np.nan)), FIC2=record(walk(2), master)) == {}
    assert slaves(LIC1=record(master)[:2], FIC2=record(walk(2), master)[:2]) == {}


def test_a_proposal_names_the_slave_and_the_list_reads_it_back():
    master = walk(1)
    found = propose(open_plant({"LIC1": record(master), "FIC2": record(walk(2), 0.4 * master)}))
    assert [one.slave for one in found] == ["FIC2", ""]
    assert "OP is the set point of FIC2: a master, without a valve of its own." in found[0].notes
    assert "SP is OP of LIC1." in found[1].notes
    assert parse_loop_list(loop_list_text(found)).loops[0].slave == "FIC2"
