"""Loops that swing together, on rows made by hand: who belongs, and who is named."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta
from functools import cache

import numpy as np
import pytest

from lostmotion.audit.groups.groups import groups
from lostmotion.audit.groups.shared import NOTHING, shared
from lostmotion.audit.groups.swinging import POWER
from lostmotion.audit.screen.lines import bands_in, lines_of
from lostmotion.diagnose.control_error.spectrum import spectrum_of
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import UNDATED, AssessmentRow, SpectrumRow, Stage

START = datetime(2026, 3, 2, tzinfo=UTC)
DAY = timedelta(days=1)
LOW, HIGH = 1e-4, 0.5


STEP = 10.0  # seconds between rows


def swing(period, of, hours=24.0, wander=0.05, begin=0.0):
    """A swing whose period comes and goes, from a moment on; the same `of`, the same swing."""
    times = np.arange(0.0, hours * 3600.0, STEP) + begin
    steps = np.random.default_rng(of).normal(size=20 * 8640)[: int(times[-1] / STEP) + 1]
    phase = 2.0 * np.pi / period * STEP * np.arange(steps.size) + wander * np.cumsum(steps)
    return np.sin(phase[int(begin / STEP) :])[: times.size]


@cache
def kept(period, of, noise=0.1, seed=0, **more):
    """Lines of a swing behind noise of a loop's own."""
    error = swing(period, of, **more)
    error = error + noise * np.random.default_rng([seed, of]).normal(size=error.size)
    return lines_of(error, np.arange(error.size) * STEP, STEP, spectrum_of(error, STEP))


def spectrum(tag, period, share=0.8, harmonics=(0.0, 0.0), start=START, of=None, **more):
    """A flat floor, a line of width 5 %, and lines at twice and three times its frequency; phases of the swing `of`."""
    edges = np.geomspace(LOW, HIGH, 97)
    power = np.full(96, (1.0 - share) / 96)
    for order, part in ((1, 1.0), (2, harmonics[0]), (3, harmonics[1])):
        place = int(np.searchsorted(edges, order / period)) - 1
        power[place] += share * part / (1.0 + sum(harmonics))
    which = round(period, -1) if of is None else of
    lines = kept(float(which), int(which), seed=ord(tag[0]))
    return SpectrumRow(tag, start, LOW, HIGH, power.astype("<f4").tobytes() + lines, **more)


def row(tag, period, power=0.8, start=START, **more):
    return AssessmentRow(tag, start, start + DAY, period=period, regularity=5.0, power=power, **more)


def valve(one, probability=0.95):
    return replace(
        one, stage=Stage.ASSESSED, verdict="stiction", kind="actuator", confidence=0.9, probability=probability
    )


def tags(group):
    return [member[0] for member in group.members]


def test_nothing_swings():
    assert groups([], []) == ()
    assert groups([spectrum("A", 300.0)], [row("A", 300.0)]) == ()
    irregular = [replace(row(tag, 300.0), regularity=0.8) for tag in "AB"]
    assert groups([spectrum("A", 300.0), spectrum("B", 300.0)], irregular) == ()


def test_records_without_dates_swing_together_within_a_file_only():
    """Nobody knows whether hours of two files that begin at zero were the same."""
    start = {"start": UNDATED}
    spectra = [spectrum(tag, 300.0, **start) for tag in "ABCD"]
    rows = [row(tag, 300.0, **start) for tag in "ABCD"]
    places = {"A": "one.csv", "B": "other.csv", "C": "one.csv", "D": "third.csv"}
    loops = {tag: PlantLoop(tag, op="OP", pv="PV", where=where) for tag, where in places.items()}
    (group,) = groups(spectra, rows, loops)
    assert sorted(tags(group)) == ["A", "C"]
    dated = [replace(one, window_start=START, window_end=START + DAY) for one in rows]
    (group,) = groups([spectrum(tag, 300.0) for tag in "ABCD"], dated, loops)
    assert len(tags(group)) == 4
    carried = [rows[0], *(replace(one, regularity=0.5) for one in rows[1:])]
    assert sorted(tags(groups(spectra, carried, loops)[0])) == ["A", "C"]


def test_records_in_memory_without_dates_swing_together_where_they_are_as_long():
    start = {"start": UNDATED}
    rows = [row(tag, 300.0, dt=1.0, **start) for tag in "ABCD"]
    rows[1] = replace(rows[1], window_end=UNDATED + 2 * DAY)
    rows[3] = replace(rows[3], dt=2.0)
    loops = {tag: PlantLoop(tag, where=tag) for tag in "ABCD"}
    (group,) = groups([spectrum(tag, 300.0, **start) for tag in "ABCD"], rows, loops)
    assert sorted(tags(group)) == ["A", "C"]


def test_the_sticking_valve_is_named_whatever_the_order():
    rows = [valve(row("A", 300.0)), row("B", 303.0), row("C", 297.0), row("D", 500.0)]
    spectra = [
        spectrum("A", 300.0, harmonics=(0.0, 0.1)),
        *(spectrum(tag, 300.0) for tag in "BC"),
        spectrum("D", 500.0),
    ]
    (group,) = groups(spectra, rows)
    assert (group.number, group.source, tags(group)) == (1, "A", ["A", "B", "C"])
    assert group.period == 300.0
    assert group.confidence > 0.6
    assert "stiction of its valve" in group.why
    assert groups(spectra[::-1], rows[::-1]) == (group,)


def test_loops_of_one_period_that_share_nothing_are_no_group():
    """Random loads of like periods have like spectra."""
    spectra = [spectrum("A", 300.0, of=300), spectrum("B", 300.0, of=301)]
    assert groups(spectra, [row("A", 300.0), row("B", 300.0)]) == ()
    carried = replace(row("B", 20.0, power=0.2), regularity=0.5)
    assert groups(spectra, [row("A", 300.0), carried]) == ()


def test_estimates_of_one_period_may_lie_apart_where_the_swing_is_shared():
    """136 and 161 s, coherence 0.96: a steam pressure that sticks and the temperature behind it."""
    spectra = [spectrum("A", 276.0, of=300), spectrum("B", 326.0, of=300)]
    (group,) = groups(spectra, [row("A", 276.0), row("B", 326.0)])
    assert sorted(tags(group)) == ["A", "B"]
    assert groups(spectra, [row("A", 276.0), row("B", 346.0)]) == (), "more than a fifth"


def test_who_swings_with_most_of_a_group_belongs_though_its_leader_is_too_far_in_period():
    spectra = [spectrum(tag, period, of=300) for tag, period in zip("ABCD", (270.0, 310.0, 312.0, 340.0), strict=True)]
    rows = [
        row(tag, period, 0.9 - 0.1 * n)
        for n, (tag, period) in enumerate(zip("ABCD", (270.0, 310.0, 312.0, 340.0), strict=True))
    ]
    (group,) = groups(spectra, rows)
    assert sorted(tags(group)) == list("ABCD")


def test_without_lines_nobody_knows_whether_a_swing_is_shared():
    spectra = [replace(one, power=one.power[:POWER]) for one in (spectrum("A", 300.0), spectrum("B", 300.0))]
    assert groups(spectra, [row("A", 300.0), row("B", 300.0)]) == ()


def windows(period, of, later=0.0, **more):
    return [(START + timedelta(seconds=later), bands_in(kept(period, of, begin=later, **more)))]


@pytest.mark.parametrize("later", [0.0, 5.0, 7000.0])
def test_windows_that_begin_at_other_times_are_compared_in_what_they_have_in_common(later):
    later = round(later / STEP) * STEP
    one, other = windows(300.0, 1), windows(300.0, 1, later, seed=1)
    found = shared(one, other, 300.0)
    assert found.coherence > 0.8
    assert found.chance < 1e-3
    assert shared(other, one, 300.0).coherence == pytest.approx(found.coherence, abs=0.02)
    alone = shared(one, windows(300.0, 2, later), 300.0)
    assert alone.coherence < 0.3
    assert shared(one, windows(300.0, 1, 3e5), 300.0) == NOTHING


def test_what_two_loops_that_share_nothing_have_in_common_is_chance():
    """The probability that is told is that of chance."""
    periods = np.random.default_rng(1).uniform(270.0, 330.0, (60, 2))
    found = [
        shared(windows(a, 2 * n, seed=n), windows(b, 2 * n + 1, seed=n), float(np.sqrt(a * b)))
        for n, (a, b) in enumerate(periods.tolist())
    ]
    assert np.mean([one.chance <= 0.1 for one in found]) <= 0.15
    assert np.mean([one.chance <= 0.5 for one in found]) >= 0.2, "nor much more than it"
    assert not any(one.chance <= 0.05 and one.coherence >= 0.4 for one in found)


@pytest.mark.parametrize(("hours", "least", "most"), [(24.0, 0.003, 0.03), (2.0, 0.005, 0.05)])
def test_pure_tones_at_one_place_are_coherent_by_chance_and_their_place_counts(hours, least, most):
    """What tones 0.1 % apart have, 145 periods long and 24: they may be one swing, and need not."""
    one, other = (
        windows(period, n, wander=0.0, noise=0.3, seed=n, hours=hours) for n, period in enumerate((300.0, 300.3))
    )
    found = shared(one, other, 300.0)
    assert found.coherence > 0.8
    assert least < found.chance < most


def test_lines_come_back_from_the_store_with_their_phases():
    times = np.arange(0.0, 86400.0, STEP)
    error = np.cos(2.0 * np.pi * times / 300.0 + 0.7)
    (found,) = (
        one for one in bands_in(lines_of(error, times, STEP, spectrum_of(error, STEP))).values() if one.seconds > 5e4
    )
    numbers = found.first + np.arange(found.values.size)
    middle = times[(times > 0.4 * found.seconds) & (times < 0.6 * found.seconds)]
    wave = np.exp(2j * np.pi * np.outer(middle, numbers) / found.seconds) @ found.values
    expected = np.exp(2j * np.pi * middle / 300.0 + 0.7j)
    cosine = np.vdot(expected, wave) / np.linalg.norm(expected) / np.linalg.norm(wave)
    assert abs(cosine) > 0.99
    assert abs(np.angle(cosine)) < 0.2, "a lag of half a block"


def test_a_gap_in_the_rows_does_not_shift_the_phases():
    """Of 44,000 s that are compared 9,000 are missing."""
    times = np.arange(0.0, 86400.0, STEP)
    there = (times < 20000.0) | (times > 29020.0)
    error = np.cos(2.0 * np.pi * times / 300.0 + 0.7)
    whole, pieces = (
        bands_in(lines_of(error[rows], times[rows], STEP, spectrum_of(error[rows], STEP)))
        for rows in (np.ones_like(there), there)
    )
    assert shared([(START, whole)], [(START, pieces)], 300.0).coherence > 0.6


def test_of_nothing_no_lines_are_kept():
    times = np.arange(0.0, 86400.0, STEP)
    some = np.sin(times)
    assert lines_of(np.full(times.size, np.nan), times, STEP, spectrum_of(some, STEP)) == b""
    assert bands_in(b"") == {}


def test_a_master_that_does_not_ring_is_carried_by_the_valve_of_its_slave():
    """It has no valve, so what it takes of the odds of a swing that no noise builds up is its slave's."""
    rows = [valve(row("F", 300.0), 0.75), row("L", 300.0, power=0.9), row("P", 300.0)]
    spectra = [spectrum(tag, 300.0) for tag in "FLP"]
    free, bound = (groups(spectra, rows, {"L": PlantLoop("L", slave=slave)}) for slave in ("", "F"))
    assert bound[0].source == "F"
    assert bound[0].confidence > free[0].confidence + 0.02
    assert tags(bound[0])[-1] == "L"


def test_a_verdict_on_a_measurement_that_stood_still_blames_nobody():
    rows = [valve(row("A", 300.0, indices={"stuck": 0.5})), row("B", 303.0), row("C", 297.0)]
    spectra = [spectrum(tag, 300.0) for tag in "ABC"]
    assert groups(spectra, rows)[0].source == ""


def test_the_group_with_most_power_comes_first():
    spectra = [spectrum(tag, period) for tag, period in zip("ABCD", (300.0, 300.0, 900.0, 900.0), strict=True)]
    rows = [row("A", 300.0, 0.3), row("B", 300.0, 0.3), row("C", 900.0, 0.9), row("D", 900.0, 0.9)]
    assert [(one.number, one.period) for one in groups(spectra, rows)] == [(1, 900.0), (2, 300.0)]


def test_time_must_be_in_common():
    later = START + 2 * DAY
    spectra = [spectrum("A", 300.0), spectrum("B", 300.0, start=later)]
    assert groups(spectra, [row("A", 300.0), row("B", 300.0, start=later)]) == ()


def test_harmonics_alone_name_nobody():
    spectra = [spectrum("A", 300.0, harmonics=(0.1, 0.3)), spectrum("B", 300.0)]
    (group,) = groups(spectra, [row("A", 300.0), row("B", 300.0)])
    assert (group.source, tags(group)) == ("", ["A", "B"])
    assert "too close" in group.why


def test_two_that_are_close_are_not_decided_between():
    rows = [valve(row("A", 300.0)), valve(row("B", 300.0))]
    (group,) = groups([spectrum(tag, 300.0) for tag in "AB"], rows)
    assert (group.source, group.confidence) == ("", None)
    assert "too close" in group.why


def test_disturbed_loops_alone_blame_nobody():
    rows = [
        replace(row(tag, 300.0), stage=Stage.ASSESSED, kind="disturbance", verdict="other oscillation") for tag in "ABC"
    ]
    (group,) = groups([spectrum(tag, 300.0) for tag in "ABC"], rows)
    assert group.source == ""


def tight(spread, kind="tuning", power=0.95):
    made = row("A", 300.0, power=power, indices={} if spread is None else {"amplitude_spread": spread})
    return replace(made, stage=Stage.ASSESSED, kind=kind, verdict="other oscillation", confidence=0.9)


def disturbed(tag, **more):
    return replace(row(tag, 300.0, **more), stage=Stage.ASSESSED, kind="disturbance")


def test_a_tight_loop_is_the_source_and_no_valve_is_blamed():
    (group,) = groups([spectrum(tag, 300.0) for tag in "ABC"], [tight(0.3), disturbed("B"), disturbed("C")])
    assert group.source == "A"
    assert "tuning" in group.why
    assert "valve" not in group.why


@pytest.mark.parametrize("spread", [None, 0.02, 0.09])
def test_what_keeps_its_amplitude_does_not_swing_from_noise(spread):
    (group,) = groups([spectrum(tag, 300.0) for tag in "ABC"], [tight(spread), disturbed("B"), disturbed("C")])
    assert group.source == ""


def test_of_loops_that_ring_the_purest_is_the_source_whatever_the_diagnosis():
    ringing = {"indices": {"amplitude_spread": 0.5}}
    rows = [tight(0.5, "disturbance"), disturbed("B", power=0.8, **ringing), disturbed("C", power=0.5, **ringing)]
    spectra = [spectrum(tag, 300.0, nonlinearity=0.2) for tag in "ABC"]
    (group,) = groups(spectra, rows)
    assert (group.source, tags(group)) == ("A", ["A", "B", "C"])
    assert "rings" in group.why
    coupled = [spectrum(tag, 300.0, nonlinearity=4.0) for tag in "ABC"]
    assert groups(coupled, rows)[0].source == "", "a linear loop does not tie phases"


def test_a_wide_swing_that_rings_is_told_by_its_period_though_its_valve_bends_it():
    """Noise is added on every way: of another one 20 times more of the variance is something else."""
    spread, bent = {"amplitude_spread": 0.6}, {"nonlinearity": 3.2}
    wide = replace(row("A", 300.0, power=0.999), regularity=600.0, indices=spread)
    other = replace(row("B", 300.0, power=0.98), regularity=500.0, indices=spread)
    spectra = [spectrum("A", 300.0, **bent), spectrum("B", 300.0)]
    assert groups(spectra, [wide, other])[0].source == "A"
    irregular = replace(wide, regularity=6.0)
    assert groups(spectra, [irregular, other])[0].source != "A", "a limit cycle whose period comes and goes"


def test_a_valve_is_blamed_by_a_sure_verdict_only():
    """Surer where the phases are coupled: what swings from outside has them as well."""

    def named(nonlinearity, *chances):
        spectra = [spectrum("A", 300.0, nonlinearity=nonlinearity), spectrum("B", 300.0)]
        return [groups(spectra, [valve(row("A", 300.0), sure), row("B", 300.0)])[0].source for sure in chances]

    assert named(None, 0.5, 0.8) == ["", "A"]
    assert named(9.0, 0.7, 0.9) == ["", "A"]


def test_a_steady_swing_with_coupled_phases_that_no_valve_explains_comes_from_outside():
    spectra = [spectrum(tag, 300.0, nonlinearity=4.0) for tag in "ABC"]
    steady = {"stage": Stage.ASSESSED, "kind": "unknown", "verdict": "cannot tell", "probability": 0.4}
    rows = [row(tag, 300.0, indices={"amplitude_spread": 0.02}, **steady) for tag in "ABC"]
    (group,) = groups(spectra, rows)
    assert (group.source, group.why) == (
        "", "cannot tell: no loop of them looks like the source; it may come from outside"
    )  # fmt: skip


def test_a_loop_is_carried_along_without_a_period_of_its_own():
    rows = [valve(row("A", 300.0)), replace(row("B", 20.0, power=0.2), regularity=0.5)]
    (group,) = groups([spectrum("A", 300.0), spectrum("B", 300.0, share=0.2)], rows)
    assert (group.source, tags(group)) == ("A", ["A", "B"])
    assert groups([spectrum("A", 300.0), spectrum("B", 300.0, share=0.0)], rows) == ()


def test_a_loop_in_which_no_period_was_found_can_be_carried_along():
    both = [spectrum("A", 60.0), spectrum("B", 60.0), spectrum("C", 60.0)]
    quiet = replace(row("C", 60.0), period=None, regularity=None, power=None)
    (group,) = groups(both, [valve(row("A", 60.0)), row("B", 60.0), quiet])
    assert "C" in tags(group)


def test_windows_of_a_loop_are_one_suspect():
    starts = [START + k * DAY for k in range(3)]
    spectra = [spectrum(tag, 300.0, start=start) for tag in "AB" for start in starts]
    rows = [row(tag, 300.0, start=start) for tag in "AB" for start in starts]
    rows[1] = valve(rows[1])
    (group,) = groups(spectra, rows)
    assert group.source == "A"
    assert sorted(member[:2] for member in group.members) == [(tag, start) for tag in "AB" for start in starts]


@pytest.mark.parametrize("power", [b"", b"\0" * 384])
def test_empty_spectra_do_no_harm(power):
    empty = replace(spectrum("A", 300.0), power=power)
    assert groups([empty, spectrum("B", 300.0)], [row("A", 300.0), row("B", 300.0)]) == ()
