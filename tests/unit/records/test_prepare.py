"""What prepare leaves out, what it keeps, and how it says so."""

import json

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, ParameterError
from lostmotion.records import LoopRecord, limits, prepare

N = 900
LOOP = lm.routine_operation(N, drift="mild", seed=3)


def record(op=None, pv=None, **settings):
    op = LOOP.command if op is None else op
    pv = LOOP.measured if pv is None else pv
    return LoopRecord(op, pv, **({"dt": 0.5} | settings))


def changed(values, start, stop, to):
    out = values.copy()
    out[start:stop] = to
    return out


def kinds(prepared):
    return [(part.start, part.stop, part.kind) for part in prepared.left_out]


def said(prepared, *parts):
    return any(all(part in note for part in parts) for note in prepared.notes)


def test_a_clean_record_is_used_as_it_is():
    given = record(sp=LOOP.reference)
    prepared = prepare(given)
    assert prepared.stretches == (given,)
    assert prepared.rows == ((0, N),)
    assert prepared.left_out == ()
    assert prepared.share == 1.0
    assert said(prepared, "SP moved in 1 row", "stays in")


def test_missing_rows_cut_and_are_told_with_rows_and_times():
    prepared = prepare(record(pv=changed(LOOP.measured, 400, 406, np.nan)))
    assert prepared.rows == ((0, 400), (406, N))
    assert kinds(prepared) == [(400, 406, "missing")]
    assert said(prepared, "rows 401 to 406 (t = 200 to 202.5 s)", "missing")
    np.testing.assert_array_equal(prepared.stretches[1].pv, LOOP.measured[406:])


def test_missing_op_is_held_between_equal_neighbours_only():
    op = changed(LOOP.command, 400, 404, LOOP.command[400])
    short = prepare(record(op=changed(op, 401, 403, np.nan)))
    assert short.left_out == ()
    assert said(short, "2 rows", "held there")
    np.testing.assert_array_equal(short.stretches[0].op, op)
    op = changed(LOOP.command, 400, 408, LOOP.command[400])
    assert kinds(prepare(record(op=changed(op, 401, 407, np.nan)))) == [(401, 407, "missing")]
    assert not said(prepare(record(op=changed(LOOP.command, 401, 402, np.nan))), "held there")


def test_gaps_cut_without_loss():
    prepared = prepare(record(gaps=(300,)))
    assert prepared.rows == ((0, 300), (300, N))
    assert all(stretch.gaps == () for stretch in prepared.stretches)
    assert said(prepared, "Time is missing in 1 place")


def test_a_recording_that_stopped():
    op, pv = changed(LOOP.command, 300, 340, LOOP.command[300]), changed(LOOP.measured, 300, 340, LOOP.measured[300])
    assert kinds(prepare(record(op=op, pv=pv))) == [(301, 340, "stopped")]


def test_a_sensor_that_stuck():
    pv = changed(LOOP.measured, 300, 340, LOOP.measured[300])
    assert kinds(prepare(record(pv=pv))) == [(301, 340, "stuck PV")]


def test_pv_that_rests_without_noise_may_be_lost_motion_and_stays():
    loop = lm.simulate_loop(
        lm.platforms.level_tank(), lm.PI(0.5, 0.7), LOOP.reference + 0.4 * np.sin(np.arange(N) / 40), 0.1
    )
    pv = np.round(changed(loop.output, 300, 380, loop.output[300]), 3)
    assert prepare(record(op=loop.command, pv=pv)).left_out == ()


def test_op_held_by_hand_while_pv_moves():
    prepared = prepare(record(op=changed(LOOP.command, 300, 420, 0.123)))
    assert kinds(prepared) == [(301, 420, "held OP")]
    assert said(prepared, "manual")


def test_steps_by_hand_are_the_best_of_data():
    op = LOOP.command.copy()
    for start, level in zip(range(300, 780, 80), (1.0, 2.0, 0.0, -2.0, 1.0, 0.5), strict=True):
        op[start : start + 80] = level
    assert prepare(record(op=op)).left_out == ()
    staircase = np.repeat([0.0, 2.0, 4.0, 2.0, 0.0, -2.0, -4.0, -2.0, 0.0], 100)
    assert prepare(record(op=staircase)).left_out == ()


def test_pv_at_the_end_of_its_range():
    pv = np.minimum(LOOP.measured, np.quantile(LOOP.measured, 0.9))
    prepared = prepare(record(pv=pv))
    assert {kind for *_, kind in kinds(prepared)} == {"clipped PV", "short"}
    assert all(np.mean(stretch.pv == pv.max()) < 0.03 for stretch in prepared.stretches)
    spanned = prepare(record(pv=pv, pv_span=(-50.0, float(pv.max()))))
    assert kinds(spanned) == kinds(prepared)


def test_op_at_its_limit_stays_and_is_told():
    prepared = prepare(record(op=np.minimum(LOOP.command, 1.1)))
    assert prepared.left_out == ()
    assert said(prepared, "upper limit (1.1)", "stays in")


def test_op_beyond_its_span_is_taken_as_the_limit():
    prepared = prepare(record(op_span=(-3.0, 1.25)))
    assert prepared.stretches[0].op.max() == 1.25
    assert said(prepared, "outside its span -3 .. 1.25", "the limit was taken")


def test_wild_samples_go_but_steps_stay():
    pv = LOOP.measured.copy()
    pv[200] += 12.0
    pv[500:] += 9.0
    assert kinds(prepare(record(pv=pv))) == [(200, 201, "outlier")]


def test_too_many_wild_samples_are_the_nature_of_the_signal():
    random = np.random.default_rng(0)
    pv = LOOP.measured + np.where(random.random(N) < 0.08, 15.0, 0.0)
    prepared = prepare(record(pv=pv))
    assert prepared.left_out == ()
    assert said(prepared, "none was left out")


def test_of_two_recordings_glued_together_the_longer_is_used():
    op, pv = LOOP.command.copy(), LOOP.measured.copy()
    op[600:] += 60.0
    pv[600:] -= 80.0
    assert kinds(prepare(record(op=op, pv=pv))) == [(600, N, "splice")]


def test_modes():
    mode = np.repeat(["AUTO", "MAN", "LOCAL", "7"], [500, 100, 100, 200])
    prepared = prepare(record(mode=mode))
    assert kinds(prepared) == [(600, 700, "mode")]
    assert said(prepared, "Manual in 100 rows")
    assert said(prepared, "Modes '7' are not known")
    assert kinds(prepare(record(mode=mode), words={"7": "detached"})) == [(600, N, "mode")]
    with pytest.raises(ParameterError, match="automatic"):
        prepare(record(mode=mode), words={"7": "off"})


def test_short_pieces_are_dropped_and_told():
    pv = LOOP.measured.copy()
    pv[40:46] = pv[850:856] = np.nan
    prepared = prepare(record(pv=pv))
    assert prepared.rows == ((46, 850),)
    assert [kind for *_, kind in kinds(prepared)] == ["short", "missing", "missing", "short"]


def test_long_pieces_are_preferred_where_they_hold_most_rows():
    pv = LOOP.measured.copy()
    pv[100:106] = pv[200:206] = np.nan
    assert prepare(record(pv=pv)).rows == ((0, 100), (106, 200), (206, N))  # without the short ones a fifth is lost
    pv = changed(LOOP.measured, 90, 96, np.nan)
    assert prepare(record(pv=pv)).rows == ((96, N),)


def test_drift_is_told():
    drifting = LOOP.command + 0.05 * np.arange(N)
    assert said(prepare(record(op=drifting, sp=np.zeros(N))), "OP drifts", "noise model")
    assert not said(prepare(record(op=drifting)), "drifts")


@pytest.mark.parametrize(
    ("settings", "part"),
    [
        ({"op": np.full(N, 3.0)}, "OP that moves, got the constant 3"),
        ({"pv": np.full(N, 3.0)}, "PV that moves, got the constant 3"),
        ({"op": np.full(N, np.nan)}, "expected OP, got only missing samples"),
        ({"pv": np.where(np.arange(N) % 40 < 6, np.nan, LOOP.measured)}, "a stretch of 60 rows"),
        ({"pv": np.interp(np.arange(N), np.arange(0, N, 37.0), LOOP.measured[::37])}, "made up by the historian"),
    ],
)
def test_refusals_are_values_and_errors_at_the_door(settings, part):
    given = record(**settings, tag="FIC-7")
    prepared = prepare(given)
    assert not prepared.usable
    assert part in prepared.refusal
    assert prepared.stretches == prepared.rows == ()
    for attempt in (
        prepared.require,
        lambda: lm.identify(given, nonlinearity="dead zone"),
        lambda: lm.identify(prepared, nonlinearity="dead zone"),
    ):
        with pytest.raises(DataError, match=r"^FIC-7: expected"):
            attempt()


def test_a_record_of_a_slower_scan_is_taken_at_that_scan():
    op, pv = (np.repeat(signal, 5)[3:] for signal in (LOOP.command, LOOP.measured))
    prepared = prepare(record(op=op, pv=pv))
    assert prepared.stretches[0].dt == 2.5
    np.testing.assert_array_equal(prepared.stretches[0].op, LOOP.command[1:])
    assert said(prepared, "only every 5th row", "2.5 s apart")


def test_result_is_json_and_text():
    pv = changed(LOOP.measured, 400, 406, np.nan)
    prepared = prepare(record(pv=np.round(pv, 1)))
    data = json.loads(json.dumps(prepared.to_dict()))
    assert data["left_out"] == [{"start": 400, "stop": 406, "kind": "missing"}]
    assert data["pv_step"] == prepared.pv_step == 0.1
    assert "894 of 900 rows in 2 pieces" in str(prepared)
    assert str(prepare(record(op=np.zeros(N)))).startswith("Refused: expected OP that moves")


def test_the_record_itself_is_never_changed():
    given = record(op=changed(LOOP.command, 100, 101, np.nan), op_span=(-2.0, 2.0))
    before = given.op.copy()
    prepare(given)
    np.testing.assert_array_equal(given.op, before)


def test_thresholds_are_shares():
    assert 0 < limits.COMPRESSED_WARN < limits.COMPRESSED_REFUSE < 1
