"""Parts of reports: changes, sizes, table, charts, text, figure."""

from __future__ import annotations

from dataclasses import replace

import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.audit.health import health_of
from lostmotion.files.write import write_table
from lostmotion.report.audit_text import audit_summary
from lostmotion.report.plant import plant_report, table
from lostmotion.report.plant.changes import changes
from lostmotion.report.plant.sizes import size_trends
from lostmotion.report.plant.svg.axis import Axis
from lostmotion.report.plant.svg.treemap import squarified, tiles_by_area, treemap
from lostmotion.report.plant.table import COLUMNS
from lostmotion.report.plant.words import headline
from lostmotion.store.rows import Stage
from tests.support.plant_rows import finding, history, plant, sound


def compared(before, now):
    view = replace(plant(), rows=(now,), previous=(before,), loops=())
    return [one.what for one in changes(view)]


def test_only_what_the_intervals_show_is_a_change_of_size():
    small, large = finding(size=2.0), finding(size=3.0)
    assert compared(small, large) == ["grew"]
    assert compared(large, small) == ["shrank"]
    assert compared(small, finding(size=2.2)) == []
    assert compared(small, replace(large, low=None, high=None)) == []


def test_what_was_not_looked_at_is_not_called_gone():
    assert compared(sound("FIC-1"), finding()) == ["new finding"]
    assert compared(finding(), sound("FIC-1")) == ["no longer found"]
    assert compared(finding(), replace(sound("FIC-1"), stage=Stage.SCREENED, verdict="cannot tell")) == []
    assert compared(finding(), replace(finding(), verdict="backlash")) == ["another fault"]
    assert compared(finding(), finding("FIC-7")) == ["new loop", "not seen any more"]


def test_trend_of_sizes_says_no_more_than_the_intervals():
    (grown,) = size_trends(plant())
    assert (grown.runs, grown.said) == (3, "larger than at first")
    first, _, last = history()
    for size, low, high, said in (
        (1.05, 0.9, 1.2, "no change that the intervals show"),
        (1.01, 1.009, 1.011, "no change that matters"),
        (0.5, 0.45, 0.55, "smaller than at first"),
    ):
        narrow = replace(first, low=0.999, high=1.001) if size == 1.01 else first
        view = replace(plant(), history=(narrow, replace(last, size=size, low=low, high=high)))
        assert size_trends(view)[0].said == said
    view = replace(plant(), history=(replace(first, low=None), last))
    assert "cannot be judged" in size_trends(view)[0].said


def test_headlines_of_rows_without_a_verdict():
    view = plant()
    said = {row.tag: headline(row) for row in view.leading}
    assert said["FIC-1"] == "Stiction, 3.00 % of span (95 %: 2.70 .. 3.30), high, confidence 93 %"
    assert said["FIC-3"] == "Cannot tell: OP hardly moves"
    assert said["FIC-4"] == "Not assessed: in manual for 97 % of the time"
    assert said["FIC-5"].startswith("No result: expected a column")
    assert "of the OP range seen" in headline(finding(indices={"op_span_known": 0.0}))
    assert "apparent, no interval" in headline(replace(finding(), low=None, high=None))


def test_health_counts_every_loop_once():
    view = replace(plant(), rows=plant().rows[:-1])
    found = health_of(view)
    parts = (found.judged, found.cannot_tell, found.screened, found.failed, found.without_row)
    assert sum(parts) == found.loops == 5
    assert found.without_row == 1


def test_table_has_all_rows_and_one_order_of_columns(tmp_path):
    view = plant()
    frame = table(view.rows, view.by_tag)
    assert frame.columns == list(COLUMNS)
    assert frame.height == len(view.rows)
    first = frame.filter(pl.col("tag") == "FIC-1")
    assert first.select("low_percent", "high_percent").row(0) == pytest.approx((2.7, 3.3))
    assert first["area"].to_list() == ["Unit FIC-1"]
    assert frame["size"].null_count() == 4
    assert str(frame["window_start"].dtype.time_zone) == "UTC"
    again = pl.read_parquet(write_table(tmp_path / "a.parquet", frame))
    assert again.equals(frame)
    assert pl.read_csv(write_table(tmp_path / "a.csv", frame)).height == frame.height
    assert table([]).schema == frame.schema


def test_only_an_undecided_loop_has_a_question_mark_in_the_treemap():
    open_loop = {"verdict": "cannot tell", "kind": "unknown", "label": "", "confidence": None}
    rows = {
        "S": finding("FIC-1", label="out of specification"),
        "!": finding("FIC-2", rule="ringing", **open_loop),
        "~": finding("FIC-3", verdict="other oscillation", kind="disturbance", label=""),
        "?": finding("FIC-4", **open_loop),
    }
    view = replace(plant(), rows=tuple(rows.values()), loops=())
    ((_, tiles),) = tiles_by_area(view.leading, view.by_tag, str)
    assert {tile.name: tile.mark for tile in tiles} == {row.tag: sign for sign, row in rows.items()}
    drawn = str(treemap(view.leading, view.by_tag, str))
    assert drawn.count("tile finding") == 1
    assert drawn.count("tile cannot-tell") == 2


@settings(max_examples=30, deadline=None)
@given(st.lists(st.floats(0.1, 100.0), min_size=1, max_size=30), st.floats(10.0, 1000.0), st.floats(10.0, 1000.0))
def test_tiles_fill_their_box_and_stay_inside(weights, wide, high):
    weights = sorted(weights, reverse=True)
    boxes = squarified(weights, (0.0, 0.0, wide, high))
    areas = [width * height for _, _, width, height in boxes]
    assert areas == pytest.approx([wide * high * weight / sum(weights) for weight in weights], rel=1e-6)
    for x, y, width, height in boxes:
        assert min(x, y) >= -1e-6
        assert x + width <= wide * (1 + 1e-6)
        assert y + height <= high * (1 + 1e-6)


@settings(max_examples=40, deadline=None)
@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6))
def test_ticks_are_inside_in_order_and_tell_each_other_apart(low, width):
    ticks = Axis(low, low + width).ticks()
    shares = [share for share, _ in ticks]
    assert 1 <= len(ticks) <= 8
    assert shares == sorted(shares)
    assert all(-1e-6 <= share <= 1 + 1e-6 for share in shares)
    if abs(low) + width < 1e6:
        assert len({text for _, text in ticks}) == len(ticks)


def test_the_text_tells_health_ranking_groups_news_and_what_to_type():
    text = audit_summary(plant())
    assert text.index("could be judged") < text.index("Where to look first") < text.index("What is new")
    told = ("3.00", "2.70 .. 3.30", "likely source FIC-1", "FIC-1: new finding", "lostmotion simulate data/FIC-1.csv")
    for said in told:
        assert said in text
    assert "\x1b" not in audit_summary(plant(("\x1b[31mred", "FIC-2", "FIC-3", "FIC-4", "FIC-5")))


def lost(tag):
    """Row of a loop that could not be read."""
    return replace(sound(tag), stage=Stage.FAILED, error="no such file", verdict="", label="", priority=None)


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([sound("FIC-1"), sound("FIC-2")], "No loop needs a hand, as far as the data tell."),
        ([sound("FIC-1"), lost("FIC-2")], "The one loop that could be judged needs no hand, as far as the data tell."),
        ([sound("FIC-1"), sound("FIC-2"), lost("FIC-3")], "None of the 2 loops that could be judged needs a hand"),
        ([lost("FIC-1"), lost("FIC-2")], ""),
    ],
)
def test_no_loop_that_was_not_judged_is_called_well(rows, said):
    tags = {row.tag for row in rows}
    view = plant()
    view = replace(
        view, rows=tuple(rows), loops=tuple(one for one in view.loops if one.tag in tags), groups=(), traces=()
    )
    text = audit_summary(view)
    assert said in text
    assert ("a hand" in text or "no hand" in text) == bool(said)
    assert ("Findings: none." in plant_report(view)) == bool(said)
    assert ("Findings: none, as no loop could be judged." in plant_report(view)) == (not said)


def test_the_figure_shows_the_ranking_and_the_health():
    pytest.importorskip("matplotlib")
    from lostmotion.plot.audit_figure import audit_figure

    axes = audit_figure(plant()).axes
    assert [one.get_title(loc="left") for one in axes][1:] == ["Verdicts", "What could be judged"]
    assert [label.get_text() for label in axes[0].get_yticklabels()] == ["FIC-1  stiction  60", "FIC-3  cannot tell  8"]
    assert len(audit_figure(replace(plant(), rows=())).axes) == 3


def test_the_last_window_of_a_loop_is_compared():
    early, late = finding(priority=90.0), replace(sound("FIC-1"), window_start=finding().window_end)
    view = replace(plant(), rows=(late, early), previous=(early,), loops=())
    assert [(one.what, one.before.split(",")[0], one.now) for one in changes(view)] == [
        ("no longer found", "stiction", "none")
    ]
