from dataclasses import replace

import numpy as np
import pytest

from lostmotion.diagnose.op_span import OpSpan
from lostmotion.diagnose.pooled.evidence import WILD, evidence_of
from lostmotion.diagnose.pooled.record_profile import RecordProfile
from lostmotion.diagnose.pooled.size_curve import SizeCurve
from lostmotion.diagnose.pooled.trend_of_size import size_trend
from lostmotion.diagnose.pooled.verdict_of_many import weigh
from lostmotion.identify.unseen_moves import Unseen

SIZES = np.geomspace(0.2, 10.0, 20)
SPAN = OpSpan(0.0, 100.0, known=True)
LOW, HIGH = 0.1, 11.0


def flat(level=0.0):
    """A record that tells the same of every size."""
    return SizeCurve(SIZES, np.full(SIZES.size, level))


def hill(size, error, gain=20.0):
    """A record that shows a size, with the standard error relative to it."""
    return SizeCurve(
        SIZES, np.full(SIZES.size, -5.0), size, gain, (size * (1 - 1.96 * error), size * (1 + 1.96 * error))
    )


def record(**curves):
    """What a record says of the kinds given; nothing of the others."""
    named = {name.replace("_", " "): curve for name, curve in curves.items()}
    return RecordProfile({"dead zone": flat(), "backlash": flat(), "stiction": flat()} | named, {}, 10.0, 500, None)


def pooled(*records):
    return evidence_of(records, LOW, HIGH)


def test_a_curve_is_its_hill_near_the_maximum_and_its_held_sizes_elsewhere():
    curve = hill(2.0, 0.02)
    at = np.array([1.0, 2.0, 2.0 * np.exp(0.02), 5.0])
    assert curve.on(at, 0.005) == pytest.approx([-5.0, 20.0, 19.5, -5.0], abs=0.05)
    assert SizeCurve(SIZES, -SIZES).on(np.array([0.1, 50.0]), 0.005) == pytest.approx([-0.1, -10.0])


def test_a_maximum_without_an_interval_is_one_more_held_size():
    curve = SizeCurve(SIZES, np.zeros(SIZES.size), 2.0, 3.0)
    assert not curve.known
    assert curve.on(np.array([2.0]), 0.005) == pytest.approx([3.0])


def test_equal_records_give_an_interval_that_shrinks_with_their_number():
    widths = []
    for number in (1, 4, 16):
        low, high = pooled(*[record(backlash=hill(2.0, 0.05))] * number).sized["backlash"].interval()
        assert low < 2.0 < high
        widths.append(high - low)
    assert widths[0] > widths[1] > widths[2]


def test_what_op_does_between_the_rows_is_in_no_average():
    for kind, more in (("backlash", 0.3), ("stiction", 0.3), ("dead zone", 0.0)):
        curve = {kind.replace(" ", "_"): hill(2.0, 0.02)}
        plain = pooled(*[record(**curve)] * 9).sized[kind]
        moved = pooled(*[replace(record(**curve), unseen=Unseen(0.3))] * 9).sized[kind]
        low, high = plain.interval()
        assert moved.interval() == pytest.approx((low - more, high + 2.0 * more))
        assert moved.largest() == pytest.approx(plain.largest() + 2.0 * more)


def test_size_of_precise_and_vague_records_is_near_the_precise():
    found = pooled(*[record(backlash=hill(2.0, 0.01))] * 3, *[record(backlash=hill(3.0, 0.3))] * 3)
    assert found.sized["backlash"].size() == pytest.approx(2.0, rel=0.03)


def test_sizes_that_differ_more_than_they_may_widen_the_interval():
    sizes = (1.5, 1.8, 2.0, 2.3, 2.7)
    apart = pooled(*(record(backlash=hill(size, 0.01)) for size in sizes)).sized["backlash"]
    alike = pooled(*[record(backlash=hill(2.0, 0.01))] * 5).sized["backlash"]
    assert np.ptp(apart.interval()) > 8 * np.ptp(alike.interval())
    assert apart.interval()[0] < 2.0 < apart.interval()[1]
    assert apart.scatter > 0.1
    assert alike.scatter < 0.05


def test_a_wild_record_moves_neither_size_nor_kind():
    good = [record(backlash=hill(2.0, 0.03))] * 5
    found = pooled(*good, record(backlash=hill(6.0, 0.01, 500.0)), record(stiction=hill(4.0, 0.01, 900.0)))
    assert found.sized["backlash"].size() == pytest.approx(2.0, rel=0.05)
    verdict = weigh(found, 1.0, SPAN, "")
    assert verdict.verdict == "backlash"
    assert verdict.carried_by is None


def test_one_record_among_many_is_bounded_and_does_not_carry_the_verdict():
    found = pooled(record(backlash=hill(2.0, 0.03, 500.0)), *[record()] * 9)
    assert found.totals()["backlash"] == pytest.approx(-np.log(WILD), abs=0.1)
    verdict = weigh(found, 1.0, SPAN, "")
    assert verdict.verdict == "cannot tell"
    assert "one record carries the evidence" in verdict.why
    assert verdict.carried_by == 0
    assert weigh(pooled(record(backlash=hill(2.0, 0.03, 500.0))), 1.0, SPAN, "").verdict == "backlash"


def test_kinds_that_are_not_told_apart_are_not_named():
    both = record(backlash=hill(2.0, 0.03), stiction=hill(2.0, 0.03))
    verdict = weigh(pooled(*[both] * 4), 1.0, SPAN, "")
    assert verdict.verdict == "cannot tell"
    assert "do not tell these apart" in verdict.why


def test_records_without_a_word_cannot_tell():
    verdict = weigh(pooled(*[record()] * 5), 1.0, SPAN, "")
    assert verdict.verdict == "cannot tell"
    assert "not excluded by all records together" in verdict.why


def test_many_quiet_records_clear_what_each_alone_cannot():
    falling = SizeCurve(SIZES, -0.3 * SIZES)
    quiet = record(dead_zone=falling, backlash=falling, stiction=falling)
    alone, together = pooled(quiet), pooled(*[quiet] * 12)
    assert alone.sized["backlash"].largest() == pytest.approx(2.706 / 0.3, rel=0.05)
    assert together.sized["backlash"].largest() == pytest.approx(2.706 / 3.6, rel=0.05)
    assert weigh(alone, 1.0, SPAN, "").verdict == "cannot tell"
    cleared = weigh(together, 1.0, SPAN, "")
    assert cleared.verdict == "none"
    assert max(cleared.excluded.values()) < 1.0
    assert weigh(together, 1.0, SPAN, "disturbance").verdict == "other oscillation"


def test_what_one_record_would_not_settle_does_not_become_sure_by_repetition():
    weak = SizeCurve(SIZES, np.full(SIZES.size, 5.0), cost=6.0)
    found = pooled(*[record(backlash=weak)] * 20)
    assert found.totals()["backlash"] == pytest.approx(0.0, abs=1e-6)
    assert SizeCurve(SIZES, np.full(SIZES.size, -9.0), cost=6.0).firm_on(SIZES, 0.005) == pytest.approx(-3.0)


def test_nothing_excluded_is_infinite():
    assert pooled(record()).sized["stiction"].largest() == np.inf


def test_a_trend_beyond_its_scatter_is_seen_and_one_within_is_not():
    days = np.arange(8.0)
    ends = [(size - 0.1, size + 0.1) for size in 1.0 + 0.2 * days]
    growing = size_trend(days, 1.0 + 0.2 * days, ends, "day")
    assert growing.seen
    assert growing.interval[0] < 0.2 < growing.interval[1]
    rng = np.random.default_rng(2)
    noisy = 2.0 + 0.5 * rng.normal(size=8)
    still = size_trend(days, noisy, [(size - 0.1, size + 0.1) for size in noisy], "day")
    assert not still.seen
    assert still.scatter > 0.2


def test_two_sizes_are_no_trend():
    found = size_trend([0, 1], [1.0, 2.0], [(0.9, 1.1), (1.9, 2.1)], "record")
    assert not found.seen
    assert found.to_dict()["slope"] is None


def test_moves_that_rounding_may_hide_count_as_those_that_are_there():
    known, perhaps = (
        pooled(*[replace(record(backlash=hill(2.0, 0.02)), unseen=unseen)] * 5).sized["backlash"]
        for unseen in (Unseen(0.3), Unseen(perhaps=0.3))
    )
    assert perhaps.interval() == known.interval()
    assert perhaps.largest() == known.largest()
    assert known.largest_known == known.interval()[1]
    assert perhaps.largest_known == pytest.approx(known.interval()[1] - 0.6)


def test_moves_of_which_nothing_tells_count_for_a_size_and_for_no_exclusion():
    none, possible = (
        pooled(*[replace(record(backlash=hill(2.0, 0.02)), unseen=unseen)] * 5).sized["backlash"]
        for unseen in (Unseen(), Unseen(untold=True, possible=0.3))
    )
    (low, high), plain = possible.interval(), none.interval()
    assert (plain[0] - low, high - plain[1]) == pytest.approx((0.3, 0.6))
    assert possible.largest() == none.largest()
    assert possible.largest_known == pytest.approx(none.largest_known)


def test_what_a_sound_valve_has_is_no_fault():
    small = hill(0.2, 0.03)
    still = [record(backlash=small, dead_zone=flat(-30.0), stiction=flat(-30.0))] * 5
    named = weigh(pooled(*still), 0.5, SPAN, "")
    assert named.verdict == "backlash"
    sound = weigh(pooled(*still), 1.0, SPAN, "")
    assert sound.verdict == "none"
    assert sound.excluded["backlash"] == pytest.approx(0.21, abs=0.02)
    assert sound.confidence == sound.probabilities["none"] > 0.7
    swinging = [replace(one, swing=0.4) for one in still]  # a fifth of the swing: that is its cause
    assert weigh(pooled(*swinging), 1.0, SPAN, "").verdict == "backlash"
