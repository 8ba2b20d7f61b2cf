"""Real actuators whose dead band can be seen in the data (../shared/actuators, cited in its README)."""

import polars as pl
import pytest

import lostmotion as lm
from tests.support.shared_data import beside, shared


def belimo(description):
    rows = pl.read_csv(beside("actuators/belimo/hunting_test300.csv")).filter(
        pl.col("description").str.starts_with(description)
    )
    return rows["setpoint"].to_numpy(), rows["position"].to_numpy()


@pytest.mark.parametrize("description", ["slow large", "slow small"])
def test_damper_holds_until_a_percent_is_missing(description):
    op, position = belimo(description)
    found = lm.actuator_response(op=op, position=position, dt=0.28)
    assert found.kind == "stiction"
    assert found.dead_band == pytest.approx(2.0, abs=0.2)


@pytest.mark.parametrize("description", ["medium oscillation", "fast small", "rapid fine", "medium large"])
def test_fast_moves_of_the_damper_do_not_tell(description):
    op, position = belimo(description)
    assert lm.actuator_response(op=op, position=position, dt=0.28).kind == "cannot tell"


@pytest.mark.parametrize(("name", "number", "ticks"), [("single", 5, 17), ("nocomp2", 1, 10)])
def test_servo_under_reversed_load(name, number, ticks):
    record = lm.read_loop(beside(f"actuators/servos/{name}.csv"), op=f"target pos ({number})", pv=f"pos ({number})")
    found = lm.actuator_response(record)
    assert found.kind == "backlash"
    assert found.dead_band == pytest.approx(ticks, abs=2)
    left_out = lm.records.prepare(record).left_out
    assert not {"stopped", "clipped PV"} & {one.kind for one in left_out}  # it rests where it was sent


def test_healthy_positioner_of_a_sugar_factory():
    path = shared("damadics/lublin_actuator3_2001-10-11_1h.csv")
    record = lm.read_loop(path, op="LC74_20CV_pct", pv="LC74_20PV_pct", position="LC74_20X_pct")
    found = lm.actuator_response(record)
    assert found.kind == "none"
    assert found.interval[1] <= 1.5
