"""Kept columns: every zoom as from the record itself, quick, and no half or foreign folder is drawn."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lostmotion.errors import DataError
from lostmotion.records import LoopRecord
from lostmotion.web.kept_record import keep_record, kept_columns, kept_record
from lostmotion.web.trend.columns import KINDS, Columns
from lostmotion.web.trend.pyramid import Pyramid
from lostmotion.web.trend.stretch import trend_of


@settings(max_examples=60)
@given(
    rows=st.integers(4096, 30_000),
    width=st.integers(1, 300),
    seed=st.integers(0, 99),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
)
def test_blocks_hide_nothing_and_invent_nothing(rows: int, width: int, seed: int, ends: tuple[float, float]) -> None:
    random = np.random.default_rng(seed)
    op = random.normal(size=rows)
    op[random.random(rows) < 0.2] = np.nan
    op[rows // 3 : rows // 2] = np.nan
    columns = Columns.of(LoopRecord(op=op, pv=random.normal(size=rows), dt=0.5), blocks=True)
    first, last = int(min(ends) * (rows - 1)), int(max(ends) * (rows - 1)) + 1
    found = trend_of(columns, first, last, width)
    assert len(found["t"]) == len(found["op"]) == len(found["pv"]) <= 2 * width
    assert found["t"] == sorted(found["t"])
    rows_of_pixels = np.round(np.array(found["t"]) / 0.5).astype(int)
    edges = [*(rows_of_pixels if found["finest"] else rows_of_pixels[::2]).tolist(), last]
    for name in ("op", "pv"):
        values = columns.signals[name].values
        step = 1 if found["finest"] else 2
        for place, (begin, end) in enumerate(pairwise(edges)):
            known = values[begin:end][np.isfinite(values[begin:end])]
            drawn = [one for one in found[name][step * place : step * place + step] if one is not None]
            assert (min(drawn, default=None), max(drawn, default=None)) == (
                (known.min(), known.max()) if known.size else (None, None)
            )


def test_edges_of_pixels_lie_where_they_should_to_an_eighth() -> None:
    columns = Columns.of(LoopRecord(op=range(100_000), pv=range(100_000), dt=1.0), blocks=True)
    found = trend_of(columns, 12_345, 98_765, 700)
    pixel = (98_765 - 12_345) / 700
    away = np.array(found["t"][::2]) - (12_345 + pixel * np.arange(700))
    assert np.abs(away).max() <= pixel / 8 + 1


@pytest.fixture
def record() -> LoopRecord:
    random = np.random.default_rng(1)
    op = random.normal(50.0, 20.0, 9000).clip(0.0, 100.0)
    op[100:130] = np.nan
    mode = np.array(["AUTO"] * 8000 + ["MAN"] * 1000)
    return LoopRecord(
        op=op, pv=op, sp=op, dt=2.0, mode=mode, op_span=(0.0, 100.0), tag="FIC-1", start="2026-03-01 06:00",
        gaps=(500, 4000), gap_seconds=(60.0, 3600.0), op_unit="%",
    )  # fmt: skip


@pytest.mark.parametrize(("start", "stop", "width"), [(0, 9000, 100), (50, 900, 700), (3990, 4010, 50)])
def test_what_is_kept_is_answered_as_in_memory(
    record: LoopRecord, tmp_path: Path, start: int, stop: int, width: int
) -> None:
    keep_record(tmp_path / "kept", record)
    from_disk = trend_of(kept_columns(tmp_path / "kept"), start, stop, width)
    assert from_disk == trend_of(Columns.of(record, blocks=True), start, stop, width)
    plain = trend_of(record, start, stop, width)
    assert {key: plain[key] for key in ("shaded", "gaps", "from", "to", "rows")} == {
        key: from_disk[key] for key in ("shaded", "gaps", "from", "to", "rows")
    }
    json.dumps(from_disk, allow_nan=False)


def test_moments_count_what_gaps_left_out(record: LoopRecord) -> None:
    found = trend_of(record, 4000, 4100, 500)
    assert found["from"] == record.moment(4000).isoformat()  # type: ignore[union-attr]
    assert found["gaps"] == []
    assert trend_of(record, 0, 9000, 10)["gaps"] == [(1000.0, 60.0), (8000.0, 3600.0)]
    assert trend_of(record, 0, 9000, 2)["gaps"] == [(1000.0, 3660.0)]


def test_a_folder_is_whole_and_replaced_as_a_whole(record: LoopRecord, tmp_path: Path) -> None:
    keep_record(tmp_path / "kept", record)
    before = kept_columns(tmp_path / "kept")
    keep_record(tmp_path / "kept", record.cut(0, 5000))
    assert len(before.signals["op"].values) == 9000, "what is open stays as it was"
    assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(".")] == ["kept"]


def test_one_folder_gives_the_record_and_what_is_drawn(record: LoopRecord, tmp_path: Path) -> None:
    folder = tmp_path / "kept"
    keep_record(folder, record)
    again, drawn = kept_record(folder), kept_columns(folder)
    for name in ("op", "pv", "sp"):
        np.testing.assert_array_equal(getattr(again, name), drawn.signals[name].values)
    assert sorted(path.name for path in folder.glob("op*")) == ["op.high.npy", "op.low.npy", "op.npy"]
    for kind in KINDS:  # as an earlier version kept it
        (folder / f"{kind}.npy").unlink()
    for path in (*folder.glob("*.low.npy"), *folder.glob("*.high.npy")):
        path.unlink()
    assert trend_of(kept_columns(folder), 0, 9000, 300) == trend_of(drawn, 0, 9000, 300)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("record.json", b"{}"),
        ("record.json", b"no json"),
        ("op.npy", b"\x93NUMPY"),
        ("op.low.npy", None),
        ("op.npy", "short"),
        ("op.npy", "pickle"),
    ],
)
def test_a_foreign_or_damaged_folder_is_told(record: LoopRecord, tmp_path: Path, name: str, content: object) -> None:
    folder = tmp_path / "kept"
    keep_record(folder, record)
    if content is None:
        (folder / name).unlink()
    elif isinstance(content, bytes):
        (folder / name).write_bytes(content)
    else:
        np.save(folder / name, np.array([1.0]) if content == "short" else np.array([{}], dtype=object))
    with pytest.raises(DataError, match="as it was kept"):
        kept_columns(folder)


def test_a_short_signal_has_no_blocks() -> None:
    assert Pyramid.of(np.arange(100.0)).low.size == 0
    assert Pyramid.of(np.arange(100.0)).block_of(1e9) == 1
