"""Loops that swing together, on rows made by hand: who belongs, and who is named."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pytest

from lostmotion.audit.groups.groups import groups
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import UNDATED, AssessmentRow, SpectrumRow, Stage

START = datetime(2026, 3, 2, tzinfo=UTC)
DAY = timedelta(days=1)
LOW, HIGH = 1e-4, 0.5


def spectrum(tag, period, share=0.8, harmonics=(0.0, 0.0), start=START, **more):
    """A flat floor, a line of width 5 %, and lines at twice and three times its frequency."""
    edges = np.geomspace(LOW, HIGH, 97)
    power = np.full(96, (1.0 - share) / 96)
    for order, part in ((1, 1.0), (2, harmonics[0]), (3, harmonics[1])):
        place = int(np.searchsorted(edges, order / period)) - 1
        power[place] += share * part / (1.0 + sum(harmonics))
    return SpectrumRow(tag, start, LOW, HIGH, power.astype("<f4").tobytes(), **more)


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


def test_periods_further_apart_than_five_percent_are_two_swings():
    spectra = [spectrum("A", 300.0), spectrum("B", 330.0)]
    assert groups(spectra, [row("A", 300.0), row("B", 330.0)]) == ()


def test_spectra_that_differ_are_no_group():
    other = spectrum("B", 300.0, share=0.3, harmonics=(6.0, 6.0))
    assert groups([spectrum("A", 300.0), other], [row("A", 300.0), row("B", 300.0, power=0.3)]) == ()


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
