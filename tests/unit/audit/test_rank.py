"""Ranking of loops: severity x weight x confidence, labels of NE 107, reasons in words."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.audit.labels import label_of, split_of
from lostmotion.audit.plant_view import leading_rows
from lostmotion.audit.rank import ranked
from lostmotion.audit.rules import advice_of
from lostmotion.plant import PlantLoop
from lostmotion.store.rows import UNDATED, AssessmentRow, GroupRow, Stage


def row(tag: str = "FIC-1", **values: object) -> AssessmentRow:
    made = {"stage": Stage.ASSESSED, **values}
    return AssessmentRow(tag, UNDATED, UNDATED, **made)  # type: ignore[arg-type]


STICKS = row(
    verdict="stiction", kind="actuator", size=3.0, low=2.8, high=3.2, size_percent=3.0, severity="high", confidence=0.96
)
CLEAR = row("FIC-2", verdict="none", kind="none", confidence=0.9, excluded_percent=0.6, severity="none")


def test_larger_surer_and_weightier_come_first() -> None:
    smaller = replace(STICKS, tag="smaller", size_percent=1.2)
    unsure = replace(STICKS, tag="unsure", confidence=0.7)
    dear = replace(STICKS, tag="dear")
    swinging = replace(STICKS, tag="swings", regularity=4.0, power=0.8, period=60.0)
    loops = {"dear": PlantLoop("dear", weight=3.0)}
    order = [one.tag for one in ranked([STICKS, smaller, unsure, dear, swinging, CLEAR], loops)]
    assert order == ["dear", "swings", "FIC-1", "unsure", "smaller", "FIC-2"]


def test_reason_says_what_counts() -> None:
    swinging = replace(STICKS, regularity=4.0, power=0.8, period=61.7)
    first = ranked([swinging], {"FIC-1": PlantLoop("FIC-1", weight=1.0), "other": PlantLoop("other", weight=2.0)})[0]
    assert first.priority_reason == (
        "stiction of 3 % of span (2.8 .. 3.2), 96 % sure; swings every 61.7 s, 80 % of the variance; "
        "weight 0.5 of the largest"
    )
    assert ranked([CLEAR], {})[0].priority_reason == "no lost motion over 0.6 % of span"


@pytest.mark.parametrize(
    ("period", "said"), [(999.0, "999 s"), (999.6, "16.7 min"), (6890.0, "115 min"), (86_400.0, "24 h")]
)
def test_a_period_has_no_power_of_ten(period: float, said: str) -> None:
    first = ranked([replace(STICKS, regularity=4.0, power=0.8, period=period)], {})[0]
    assert f"swings every {said}, 80 % of the variance" in first.priority_reason


def test_what_was_not_judged_has_no_priority_but_a_reason() -> None:
    failed = row("A", stage=Stage.FAILED, error="no PV")
    stale = row("B", fit_for_use=False, health=("stale for 90 % of the time",))
    waiting = row("C", stage=Stage.SCREENED, reason="the budget was spent")
    found = ranked([failed, stale, waiting, STICKS], {})
    assert [one.tag for one in found] == ["FIC-1", "B", "C", "A"]
    assert [one.priority for one in found[1:]] == [None] * 3
    assert [one.priority_reason for one in found[1:]] == [
        "not judged: stale for 90 % of the time",
        "not assessed: the budget was spent",
        "not judged: no PV",
    ]


def test_labels_and_split() -> None:
    kinds = {
        "maintenance required": STICKS,
        "out of specification": replace(STICKS, size_percent=6.0, severity="severe"),
        "failure": replace(STICKS, size_percent=70.0, severity="severe"),
        "normal": CLEAR,
        "function check": replace(STICKS, manual=0.95),
        "": row(verdict="cannot tell", kind="unknown", probability=0.6),
    }
    assert {label_of(one): label for label, one in kinds.items()} == {label: label for label in kinds}
    assert label_of(replace(STICKS, severity="low", size_percent=0.7)) == "normal"
    assert split_of(row(verdict="other oscillation", kind="disturbance")) == "process"
    assert split_of(row(verdict="cannot tell", kind="actuator")) == "cannot tell"


def test_a_loop_that_cannot_be_told_but_is_suspected_comes_behind_one_that_is_told() -> None:
    open_ = row("open", verdict="cannot tell", kind="unknown", probability=0.9)
    calm = row("calm", verdict="cannot tell", kind="unknown", probability=0.05)
    found = ranked([calm, open_, STICKS], {})
    assert [one.tag for one in found] == ["FIC-1", "open", "calm"]
    assert found[2].priority == 0.0


def test_a_suspect_is_worth_a_test_by_its_probability_and_by_the_size_that_is_left_open() -> None:
    """0.25 is the prior of any valve: a record that says no more is no reason; nor is a size that hardly matters."""
    made = {"verdict": "cannot tell", "kind": "unknown", "excluded_percent": 6.0}
    likely, unlikely, prior = (row(f"FIC-{p}", probability=p, **made) for p in (0.39, 0.3, 0.25))
    small, unknown = row("small", **{**made, "probability": 0.39, "excluded_percent": 0.5}), replace(likely, tag="none")
    unknown = replace(unknown, excluded_percent=None)
    found = {one.tag: one.priority for one in ranked([prior, unlikely, likely, small, unknown], {})}
    assert found["FIC-0.39"] == pytest.approx(100.0 * 0.5 * 0.7 * 0.5 * 0.39)
    assert found["FIC-0.39"] == found["none"] > found["FIC-0.3"] > found["small"] > found["FIC-0.25"] == 0.0
    seen = replace(likely, excluded_percent=0.5, indices={"op_span_known": 0.0})
    assert ranked([seen], {})[0].priority == found["none"], "of the range seen: a size in % of span is not known"


def test_loops_of_one_priority_are_in_the_order_of_what_their_records_say() -> None:
    """The prior is worth nothing, but 24 % is more than 4 %, and a valve that may stand still more than a tight one."""
    made = {"verdict": "cannot tell", "kind": "unknown"}
    rows = [row("a", probability=0.04, **made), row("b", probability=0.2, excluded_percent=1.5, **made),
            row("c", probability=0.2, excluded_percent=9.0, **made), row("d", probability=0.24, **made),
            CLEAR]  # fmt: skip
    found = ranked(rows, {})
    assert [one.tag for one in found] == ["d", "c", "b", "a", "FIC-2"]
    assert {one.priority for one in found} == {0.0}
    assert [one.tag for one in leading_rows(found)] == [one.tag for one in found]


def test_a_fault_that_one_stretch_shows_comes_before_what_nothing_speaks_for() -> None:
    made = {"verdict": "cannot tell", "kind": "unknown", "excluded_percent": float("inf")}
    said = "one of three stretches shows a backlash of 2.5 % of span, the others cannot tell"
    shown = row("shown", probability=0.57, why=said, indices={"shown_percent": 2.5}, **made)
    silent = row("silent", probability=0.57, **made)
    slow = row("slow", probability=0.2, regularity=3.0, power=0.9, period=3000.0, **made)
    first, second, third = ranked([slow, silent, shown], {})
    assert (first.tag, second.tag, third.tag) == ("shown", "slow", "silent")
    assert first.priority == pytest.approx(100.0 * 0.57 * 0.7 * 0.5), "of 2 % at most"
    assert first.priority_reason == f"{said}; a fault of the actuator is 57 % likely"
    assert first.label == ""


def test_an_error_that_could_be_less_is_a_reason_where_nothing_else_is_told() -> None:
    """Noise that no controller takes away is none, nor is what a swing of another loop does."""
    loops = {tag: PlantLoop(tag, pv_span=(0.0, 50.0)) for tag in ("loud", "noisy", "small", "swings")}
    made = {"verdict": "cannot tell", "kind": "unknown", "probability": 0.2}
    rows = [row("loud", variability=1.0, harris=0.19, **made), row("noisy", variability=1.0, harris=0.97, **made),
            row("small", variability=0.2, harris=0.19, **made), row("loud without span", variability=1.0, **made),
            row("swings", variability=1.0, harris=0.19, regularity=9.0, power=0.9, period=60.0, **made)]  # fmt: skip
    group = GroupRow(1, 60.0, "elsewhere", 0.9, "", (("swings", UNDATED, 1.0, 0.0),))
    found = {one.tag: one for one in ranked(rows, loops, [group])}
    assert found["loud"].priority == pytest.approx(100.0 * 0.5 * 0.3 * 0.45)
    assert found["loud"].priority_reason.endswith("; error of control 0.9 % of span that could be less")
    assert found["noisy"].priority == pytest.approx(100.0 * 0.5 * 0.3 * 0.5 * 0.03**0.5)
    assert "error of control" not in found["noisy"].priority_reason + found["small"].priority_reason
    assert found["loud without span"].priority == 0.0
    assert found["swings"].priority == pytest.approx(100.0 * 0.5 * 0.3 * 0.25 * 0.9), "it comes with the swing"
    level = replace(loops["loud"], loop_type="level")
    assert ranked(rows[:1], {"loud": level})[0].priority == 0.0, "a level may wander: it is a buffer"


def test_a_measurement_that_stood_still_is_a_fact_and_an_end_of_op_is_no_valve() -> None:
    frozen = row("frozen", verdict="cannot tell", kind="unknown", indices={"stuck": 0.24}, fit_for_use=False)
    limited = row("limited", verdict="saturation", kind="actuator", limited=0.8)
    found = {one.tag: one for one in ranked([frozen, limited], {})}
    assert (found["frozen"].split, found["frozen"].label) == ("sensor", "failure")
    assert "stood still for 24 % of the time" in found["frozen"].priority_reason
    assert (found["limited"].split, found["limited"].label) == ("process", "out of specification")
    assert found["limited"].priority == pytest.approx(24.0)
    recording = replace(frozen, indices={"stuck": 0.05, "stale": 0.59}, health=("stale for 59 % of the time",))
    assert ranked([recording], {})[0].priority is None, "most of the time it stands still while OP does, too"
    ended = replace(recording, limited=0.54, verdict="saturation", kind="actuator", fit_for_use=True)
    assert split_of(ended) == "sensor", "OP has run to its limit, and stands there"
    told = replace(STICKS, indices={"stuck": 0.24})
    assert split_of(told) == "actuator", "the valve is the finding"


@given(
    st.lists(
        st.builds(
            row,
            tag=st.text(min_size=1, max_size=3),
            verdict=st.sampled_from(["none", "stiction", "saturation", "other oscillation", "cannot tell"]),
            kind=st.sampled_from(["none", "actuator", "tuning", "disturbance", "set point", "sensor", "unknown"]),
            size_percent=st.none() | st.floats(0.01, 100.0),
            confidence=st.none() | st.floats(0.0, 1.0),
            probability=st.none() | st.floats(0.0, 1.0),
            regularity=st.none() | st.floats(0.0, 1000.0),
            power=st.none() | st.floats(0.0, 1.0),
            manual=st.none() | st.floats(0.0, 1.0),
            stage=st.sampled_from(list(Stage)),
        ),
        max_size=6,
    )
)
def test_priorities_lie_in_0_to_100_and_fall(rows: list[AssessmentRow]) -> None:
    found = ranked(rows, {})
    known = [one.priority for one in found if one.priority is not None]
    assert all(0.0 <= one <= 100.0 for one in known)
    assert known == sorted(known, reverse=True)
    assert len(found) == len(rows)
    assert all(one.priority_reason for one in found)


def test_a_measurement_that_scatters_is_a_fact_whatever_the_diagnosis_says() -> None:
    noisy = row(travel=4000.0, indices={"scatter_percent": 2.5}, stage=Stage.SCREENED, reason="OP moves little")
    first = ranked([noisy], {})[0]
    assert (first.split, first.label) == ("sensor", "maintenance required")
    assert first.priority_reason == (
        "PV scatters over 15 % of span from row to row: look at the measurement and its damping; "
        "OP travels 40 full strokes an hour: wear"
    )
    assert 26.0 < first.priority < 55.0
    usual = replace(noisy, indices={"scatter_percent": 0.5}, travel=40.0)
    assert ranked([usual], {})[0].priority is None
    coarse = replace(noisy, indices={"scatter_percent": 2.5, "stale": 0.94}, fit_for_use=False)
    assert ranked([coarse], {})[0].priority is None, "steps of a resolution in which PV rests"
    fast = replace(noisy, regularity=5.0, power=0.9, period=6.0, dt=1.0)
    assert split_of(fast) == "cannot tell"
    assert split_of(replace(STICKS, indices={"scatter_percent": 2.5})) == "actuator"


def test_a_valve_that_never_rests_is_told() -> None:
    tight = row(verdict="other oscillation", kind="tuning", confidence=0.9, regularity=9.0, power=0.9, period=10.0)
    busy, calm = (ranked([replace(tight, travel=travel)], {})[0] for travel in (9000.0, 1900.0))
    assert busy.priority > calm.priority + 20.0
    assert busy.priority_reason.endswith("OP travels 90 full strokes an hour: wear")
    assert "wear" not in calm.priority_reason
    seen = ranked([replace(tight, travel=9000.0, indices={"op_span_known": 0.0})], {})[0]
    assert "wear" not in seen.priority_reason, "strokes of the range seen are none of the valve"


def test_a_loop_that_swings_because_of_another_one_comes_after_it() -> None:
    made = {"verdict": "other oscillation", "confidence": 0.9, "regularity": 9.0, "power": 0.9, "period": 100.0}
    source, other = row("FIC-1", kind="tuning", **made), row("FIC-2", kind="disturbance", **made)
    group = GroupRow(1, 100.0, "FIC-1", 0.9, "", (("FIC-1", UNDATED, 1.0, 2.0), ("FIC-2", UNDATED, 1.0, 0.0)))
    first, second = ranked([other, source], {}, [group])
    assert (first.tag, second.tag) == ("FIC-1", "FIC-2")
    assert second.priority == pytest.approx(0.25 * first.priority)
    assert second.priority_reason.endswith("with FIC-1, the likely source: look there first")
    unknown = ranked([other, source], {}, [replace(group, source="")])[1]
    assert unknown.priority == pytest.approx(0.5 * first.priority), "disturbed from somewhere: not the first to go to"
    assert unknown.priority_reason.startswith("not the actuator: look upstream")
    moved = ranked([replace(other, kind="set point"), source], {}, [replace(group, source="")])[1]
    assert moved.priority == unknown.priority, "nothing is to be done in this loop"
    assert moved.priority_reason.startswith("not the actuator: look at what moves SP")
    worn = replace(STICKS, tag="FIC-2", regularity=9.0, power=0.9, period=100.0)
    assert ranked([worn], {}, [group]) == ranked([worn], {}), "a lost motion of its own is mended whoever swings"


@pytest.mark.parametrize(("verdict", "kind"), [("cannot tell", "unknown"), ("none", "none"),
                                               ("other oscillation", "disturbance"),
                                               ("other oscillation", "unknown")])  # fmt: skip
def test_a_loop_that_rings_is_to_be_tuned_whatever_the_diagnosis_sees(verdict: str, kind: str) -> None:
    rings = row(
        verdict=verdict, kind=kind, confidence=0.6, regularity=40.0, power=0.9, period=300.0,
        indices={"amplitude_spread": 0.5},
    )  # fmt: skip
    (first,) = ranked([rings], {})
    assert first.split == "tuning"
    assert first.priority == pytest.approx(36.0)
    assert first.priority_reason.startswith("hardly settles: retune (its amplitude comes and goes); swings every 300 s")
    for calm in (replace(rings, indices={"amplitude_spread": 0.2}), replace(rings, regularity=3.0)):
        assert "retune" not in ranked([calm], {})[0].priority_reason
    group = GroupRow(1, 300.0, "FIC-2", 0.9, "", (("FIC-1", UNDATED, 1.0, 0.0),))
    carried = ranked([rings], {}, [group])[0]
    assert carried.split != "tuning"
    pure = row("FIC-3", regularity=90.0, power=0.97, period=300.0, indices={"amplitude_spread": 0.03})
    both = replace(group, source="", members=(("FIC-3", UNDATED, 1.0, 0.0), *group.members))
    assert all(one.split != "tuning" for one in ranked([rings, pure], {}, [both])), "it is forced from outside"
    assert "look there first" in carried.priority_reason


SCREENED = row(
    stage=Stage.SCREENED, reason="the budget was spent", regularity=40.0, power=0.9, period=300.0,
    indices={"amplitude_spread": 0.5},
)  # fmt: skip


def test_a_loop_that_was_only_screened_is_ranked_by_what_needs_no_diagnosis() -> None:
    """As one that was diagnosed, of which its diagnosis says nothing; all else waits for a diagnosis."""
    rings, told = ranked([SCREENED], {})[0], ranked([replace(SCREENED, stage=Stage.ASSESSED)], {})[0]
    assert (rings.rule, rings.priority, rings.split, rings.label) == ("ringing", told.priority, "tuning", "")
    assert rings.priority_reason.endswith("90 % of the variance; only screened: the budget was spent")
    busy = ranked([replace(SCREENED, regularity=0.5, travel=9000.0)], {})[0]
    assert (busy.rule, busy.label) == ("wear by travel", "")
    assert busy.priority == pytest.approx(30.0 * (1.0 - 20.0 / 90.0))
    assert busy.priority_reason == "OP travels 90 full strokes an hour: wear; only screened: the budget was spent"
    group = GroupRow(1, 300.0, "FIC-2", 0.9, "", (("FIC-1", UNDATED, 1.0, 0.0),))
    waits = (
        replace(SCREENED, regularity=3.0),
        replace(SCREENED, indices={"amplitude_spread": 0.03}),
        replace(SCREENED, manual=0.95),
        replace(SCREENED, limited=0.6),
        replace(SCREENED, fit_for_use=False),
    )
    for one in (*(ranked([each], {})[0] for each in waits), ranked([SCREENED], {}, [group])[0]):
        assert (one.priority, one.rule, one.split) == (None, "", "cannot tell")


def test_of_a_master_its_tuning_is_told_and_nothing_of_a_valve() -> None:
    loops = {"FIC-1": PlantLoop("FIC-1", slave="FIC-2")}
    master = replace(SCREENED, reason="a master, without a valve of its own", travel=9000.0)
    rings = ranked([master], loops)[0]
    assert (rings.rule, rings.split, rings.label) == ("ringing", "tuning", "")
    assert "wear" not in rings.priority_reason
    assert advice_of(rings)[0].startswith("Retune")
    assert ranked([replace(master, regularity=0.5)], loops)[0].priority is None, "its travel wears no valve"


def test_a_swing_that_keeps_its_amplitude_is_not_blamed_on_tuning() -> None:
    """Noise builds the swing of a tight loop up and takes it away; whoever is forced swings as whoever forces it."""
    made = {"verdict": "other oscillation", "kind": "tuning", "confidence": 0.9, "regularity": 9.0, "power": 0.9}
    tight = row(period=100.0, indices={"amplitude_spread": 0.5}, **made)
    forced = replace(tight, tag="FIC-2", indices={"amplitude_spread": 0.03})
    first, second = ranked([forced, tight], {})
    assert (first.tag, first.split, second.split) == ("FIC-1", "tuning", "process")
    assert second.priority == pytest.approx(0.5 * first.priority)
    assert second.priority_reason.startswith("not the actuator: look upstream")
    assert second.priority_reason.endswith("its amplitude stays: not its tuning")
    assert "amplitude stays" not in first.priority_reason
    unknown = replace(forced, indices={})
    assert split_of(unknown) == "tuning", "too few cycles to tell"
    named = GroupRow(1, 100.0, "FIC-2", 0.9, "", (("FIC-2", UNDATED, 1.0, 2.0),))
    assert ranked([forced], {}, [named])[0].split == "tuning", "the source of its group by all that is known"


def test_a_measurement_that_scatters_more_than_others_of_its_type() -> None:
    made = {"verdict": "none", "kind": "none", "confidence": 0.9}
    loops = {f"TIC-{n}": PlantLoop(f"TIC-{n}", loop_type="temperature") for n in range(6)}
    quiet = [row(f"TIC-{n}", indices={"scatter_percent": 0.04}, **made) for n in range(5)]
    noisy = row("TIC-5", indices={"scatter_percent": 0.5}, **made)
    first = ranked([*quiet, noisy], loops)[0]
    assert (first.tag, first.split) == ("TIC-5", "sensor")
    assert "3 % of span from row to row, 12 times what is usual in its type" in first.priority_reason
    assert first.priority == pytest.approx(35.0 * (1.0 - 4.0 / 12.5))
    few = ranked([*quiet[:3], noisy], loops)[0]
    assert few.split == "none", "three others do not tell what is usual"
