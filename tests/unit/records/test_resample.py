import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.records import LoopRecord, resample
from lostmotion.records.resample import pick


def record(n=100, **settings):
    return LoopRecord(np.arange(n) * 1.0, np.arange(n) * 10.0, **({"dt": 0.5} | settings))


def test_op_is_a_sample_and_pv_the_mean_before_it():
    slower = resample(record(11, sp=np.arange(11.0), mode=["AUTO"] * 11), 3)
    assert slower.op.tolist() == slower.sp.tolist() == [3.0, 6.0]
    assert slower.pv.tolist() == [20.0, 50.0]  # of rows 1 to 3 and 4 to 6
    assert slower.dt == 1.5
    assert slower.mode.tolist() == ["AUTO", "AUTO"]
    assert "OP of one" in slower.notes[-1]


def test_factor_one_is_the_record_itself():
    given = record()
    assert resample(given, 1) is given


def test_no_block_crosses_a_gap():
    slower = resample(record(30, gaps=(14,)), 4)
    assert slower.op.tolist() == [4.0, 8.0, 18.0, 22.0, 26.0]
    assert slower.gaps == (2,)


def test_missing_samples():
    pv = np.arange(20) * 10.0
    pv[[4, 9, 10, 11]] = np.nan
    op = np.arange(20.0)
    op[16] = np.nan
    slower = resample(LoopRecord(op, pv, dt=1.0), 4)
    np.testing.assert_array_equal(slower.pv, [20.0, 65.0, np.nan, 145.0])
    np.testing.assert_array_equal(slower.op, [4.0, 8.0, 12.0, np.nan])


@pytest.mark.parametrize("factor", [0, -1, 1.5, "2", True])
def test_factor_is_checked(factor):
    with pytest.raises(ParameterError, match="factor"):
        resample(record(), factor)


def test_too_few_blocks():
    with pytest.raises(DataError, match="2 blocks of 60 rows"):
        resample(record(), 60)


def test_pick_keeps_rows():
    assert pick(record(10), 3, 1).op.tolist() == [1.0, 4.0, 7.0]


def test_a_held_command_loses_nothing_but_noise():
    """OP that is held for whole blocks: the resampled record is of the same Hammerstein model."""
    model = lm.Hammerstein(lm.DeadZone(-0.7, 1.2), lm.LinearModel([-0.98], [0.02], 1))
    u = lm.signals.prs(4000, -5, 5, hold=20, seed=4)
    y = model.simulate(u)
    fit = lm.identify(resample(LoopRecord(u, y, dt=1.0), 10), orders=(1, 1, 1), noise="white", nonlinearity="dead zone")
    assert fit.parameters["left"] == pytest.approx(-0.7, abs=1e-6)
    assert fit.parameters["right"] == pytest.approx(1.2, abs=1e-6)
