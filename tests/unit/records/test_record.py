import numpy as np
import pytest

from lostmotion.errors import DataError, ParameterError
from lostmotion.records import LoopRecord

OP = [1.0, 2.0, np.nan, 4.0, 5.0, 6.0]
PV = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5]


def test_signals_are_copied_and_cannot_be_written():
    op = np.array(OP)
    record = LoopRecord(op, PV, dt=1.0)
    op[0] = 9.0
    assert record.op[0] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        record.op[0] = 9.0


def test_repr_and_length():
    record = LoopRecord(OP, PV, sp=PV, position=PV, dt=0.5, tag="A", gaps=(2, 4))
    assert repr(record) == "LoopRecord('A': 6 samples of OP, PV, SP, POSITION every 0.5 s, 3 s, 2 gaps)"
    assert len(record) == 6


def test_cut_keeps_gaps_notes_and_spans():
    record = LoopRecord(OP, PV, sp=PV, dt=1.0, gaps=(1, 3), notes=("x.",), op_span=(0, 9)).cut(1, 5)
    assert (record.gaps, record.notes, record.op_span) == ((2,), ("x.",), (0, 9))
    np.testing.assert_array_equal(record.sp, PV[1:5])


def test_split_at_missing_samples_and_gaps():
    pieces = LoopRecord(OP, PV, dt=1.0, gaps=(4,)).split()
    assert [piece.op.tolist() for piece in pieces] == [[1.0, 2.0], [5.0, 6.0]]
    assert LoopRecord(OP, PV, dt=1.0).split(shortest=3)[0].op.tolist() == [4.0, 5.0, 6.0]


def test_fingerprint_is_of_the_data():
    record = LoopRecord(OP, PV, dt=1.0)
    assert record.fingerprint == LoopRecord(OP, PV, dt=1.0, tag="other", notes=("y.",)).fingerprint
    assert record.fingerprint != LoopRecord(OP, PV, dt=2.0).fingerprint


@pytest.mark.parametrize(
    ("changed", "error", "said"),
    [
        ({"dt": 0.0}, ParameterError, "dt > 0"),
        ({"dt": np.nan}, ParameterError, "dt > 0"),
        ({"op_span": (1, 1)}, ParameterError, "low < high"),
        ({"pv": PV[:-1]}, DataError, "6 samples as op"),
        ({"op": [1.0], "pv": [1.0]}, DataError, "at least 2"),
        ({"op": ["a"] * 6}, DataError, "op as numbers"),
        ({"op": [OP]}, DataError, "one dimension"),
        ({"pv": [np.inf, *PV[1:]]}, DataError, "finite pv"),
    ],
)
def test_refusals(changed, error, said):
    with pytest.raises(error, match=said):
        LoopRecord(**({"op": OP, "pv": PV, "dt": 1.0} | changed))


def test_mode_is_text_and_is_cut_with_the_rest():
    record = LoopRecord(OP, PV, dt=1.0, mode=["AUTO", "AUTO", "MAN", "MAN", "", "AUTO"])
    assert record.cut(1, 3).mode.tolist() == ["AUTO", "MAN"]
    with pytest.raises(DataError, match="mode with 6 samples"):
        LoopRecord(OP, PV, dt=1.0, mode=["AUTO"])
    with pytest.raises(DataError, match="mode of one dimension"):
        LoopRecord(OP, PV, dt=1.0, mode=[["AUTO"] * 6])


@pytest.mark.parametrize("dt", [5e-324, 1e-13, 1e13, 1.7e308])
def test_no_record_has_such_a_sampling_time(dt):
    with pytest.raises(ParameterError, match="dt from 1e-12 to"):
        LoopRecord([1.0, 2.0], [3.0, 4.0], dt=dt)


@pytest.mark.parametrize("span", [(-1e308, 1e308), (0.0, 1e300), (-1e9, 100.0), (0.0, float("inf"))])
def test_no_signal_has_such_a_span(span):
    for name in ("op_span", "pv_span"):
        with pytest.raises(ParameterError, match=f"{name} within"):
            LoopRecord([1.0, 2.0], [3.0, 4.0], dt=1.0, **{name: span})
    assert LoopRecord([1e-3, 2e-3], [3.0, 4.0], dt=1.0, op_span=(0.0, 100.0)).op_span == (0.0, 100.0)
