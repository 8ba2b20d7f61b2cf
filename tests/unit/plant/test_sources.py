"""Sources of a plant: every shape gives the same records as read_loop; what gives none is said."""

import os
import pickle
import socket
import subprocess
import tracemalloc
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import polars as pl
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, FileAccessError, InputError, LostMotionError, ParameterError
from lostmotion.plant import PlantLoop, files_source, open_plant, propose
from lostmotion.plant.address import Place, parsed, written
from lostmotion.plant.period import Period
from lostmotion.plant.pooled import pooled
from lostmotion.records import LoopRecord
from tests.support.plants import KINDS, START, TAGS, N, below_each_other, frame, make, put, side_by_side, signals


def records(plant, loops=None, **when):
    return {loop.tag: record for loop, record in plant.read(plant.loops() if loops is None else loops, **when)}


@pytest.mark.sampled(8)
@pytest.mark.parametrize("kind", KINDS)
def test_every_source_gives_what_read_loop_gives(tmp_path, kind):
    source, settings = make(kind, tmp_path / "plant" if "database" not in kind else tmp_path)
    plant = pickle.loads(pickle.dumps(open_plant(source, **settings)))  # noqa: S301  of our own
    loops = plant.loops()
    assert sorted(loop.tag for loop in loops) == sorted(TAGS)
    assert not plant.unread()
    assert {loop.loop_type for loop in loops} == {"flow", "level", "pressure"}
    found = records(plant, loops)
    for number, tag in enumerate(TAGS):
        alone = lm.read_loop(frame(number), tag=tag)
        one = found[tag]
        assert isinstance(one, LoopRecord), one
        for name in ("op", "pv", "sp"):
            np.testing.assert_array_equal(getattr(one, name), getattr(alone, name))
        assert (one.tag, one.dt, one.start, one.loop_type) == (tag, alone.dt, alone.start, alone.loop_type)
        assert one.fingerprint == alone.fingerprint


@pytest.mark.parametrize("kind", ["files parquet", "wide csv", "partitions", "days csv"])
def test_size_stamp_and_address(tmp_path, kind):
    source, _ = make(kind, tmp_path)
    loops = open_plant(source).loops()
    assert all(loop.size > 0 and loop.stamp and loop.where for loop in loops)
    total = sum(path.stat().st_size for path in tmp_path.rglob("*") if path.is_file())
    assert sum(loop.size for loop in loops) <= total
    for path in tmp_path.rglob("*.*"):
        if path.is_file():
            path.write_bytes(path.read_bytes() + b" ")
    assert not {loop.stamp for loop in loops} & {loop.stamp for loop in open_plant(source).loops()}


def test_a_worker_reads_without_looking_for_loops(tmp_path, monkeypatch):
    source, _ = make("files parquet", tmp_path)
    plant = open_plant(source)
    loops = plant.loops()
    sent = pickle.dumps(plant)
    monkeypatch.setattr("lostmotion.plant.files_source.surveyed", lambda *_: pytest.fail("looked again"))
    assert len(records(pickle.loads(sent), loops)) == 3  # noqa: S301
    assert len(sent) < 1000


def test_a_file_of_many_loops_is_opened_once(tmp_path, monkeypatch):
    source, _ = make("wide csv", tmp_path)
    plant = open_plant(source)
    seen = []
    from lostmotion.plant import files_source

    real = files_source.opened
    monkeypatch.setattr(files_source, "opened", lambda *args, **named: seen.append(args) or real(*args, **named))
    assert len(records(plant)) == 3
    assert len(seen) == 1


def test_records_in_memory():
    given = [LoopRecord(**{k.lower(): v for k, v in signals(k).items()}, dt=1.0, tag=tag) for k, tag in enumerate(TAGS)]
    plant = open_plant(given)
    assert records(plant)["LIC102"] is given[1]
    assert open_plant({"A": given[0]}).loops()[0].tag == "A"
    with pytest.raises(DataError, match=r"records of different tags, got 'FIC101' as records 1 and 2"):
        open_plant([given[0], given[0]])
    with pytest.raises(DataError, match="a tag of each record, got none in record 1 of 1"):
        open_plant([replace(given[0], tag="")])


def test_a_frame():
    assert records(open_plant(side_by_side()))["PIC103"].op[0] == signals(2)["OP"][0]


def test_from_and_to(tmp_path):
    source, _ = make("files csv", tmp_path)
    plant = open_plant(source)
    since, until = START + timedelta(seconds=60), START + timedelta(seconds=100)
    one = records(plant, since=since, until=until)["FIC101"]
    np.testing.assert_array_equal(one.op, signals(0)["OP"][60:100])
    assert one.start == since
    nothing = records(plant, since=START + timedelta(days=9))["FIC101"]
    assert isinstance(nothing, DataError)
    assert "rows of 2026-03-10" in str(nothing)
    with pytest.raises(ParameterError, match="since with a time zone"):
        list(plant.read(plant.loops(), since=datetime(2026, 3, 1)))
    with pytest.raises(ParameterError, match="since before until"):
        list(plant.read(plant.loops(), since=until, until=since))


def test_from_and_to_without_dates_or_zone(tmp_path):
    put(tmp_path / "FIC1.csv", frame(0).with_columns(pl.Series("time", range(N))))
    put(tmp_path / "FIC2.csv", frame(1).with_columns(pl.col("time").dt.replace_time_zone(None)))
    found = records(open_plant(tmp_path), since=START + timedelta(seconds=60))
    assert len(found["FIC1"]) == N
    assert "not dated" in found["FIC1"].notes[-1]
    assert len(found["FIC2"]) == N - 60
    assert "compared as UTC" in found["FIC2"].notes[-1]


def test_records_of_different_times_are_one_loop(tmp_path):
    for day in range(3):
        put(tmp_path / f"FIC101__030{day}_0005.csv", frame(day, start=START + timedelta(days=day)))
    (loop,) = open_plant(tmp_path).loops()
    record = records(open_plant(tmp_path))["FIC101"]
    assert (loop.tag, len(record), record.gaps) == ("FIC101", 3 * N, (N, 2 * N))
    assert record.gap_seconds == (86400.0 - N, 86400.0 - N)
    part = records(open_plant(tmp_path), since=START + timedelta(days=1), until=START + timedelta(days=2))["FIC101"]
    np.testing.assert_array_equal(part.op, signals(1)["OP"])


def test_exports_that_repeat_the_end_of_the_one_before(tmp_path):
    whole = frame(0)
    put(tmp_path / "FIC101_1.csv", whole[:150])
    put(tmp_path / "FIC101_2.csv", whole[100:])
    (loop,) = open_plant(tmp_path).loops()
    record = records(open_plant(tmp_path))["FIC101"]
    assert loop.tag == "FIC101"
    assert record.gaps == ()
    np.testing.assert_array_equal(record.op, whole["OP"])
    put(tmp_path / "FIC101_2.csv", frame(5)[100:])
    error = records(open_plant(tmp_path))["FIC101"]
    assert "expected one record of a loop at a time" in str(error)
    assert "loop list" in str(error)


def test_one_tag_in_two_units_at_the_same_time(tmp_path):
    put(tmp_path / "unit 1" / "FIC101.csv", frame(0))
    put(tmp_path / "unit 2" / "FIC101.csv", frame(1))
    loops = open_plant(tmp_path).loops()
    assert [(loop.tag, loop.area) for loop in loops] == [("unit 1/FIC101", "unit 1"), ("unit 2/FIC101", "unit 2")]


def test_undated_runs_are_loops_of_their_own(tmp_path):
    for run in (1, 2):
        put(tmp_path / f"FIC101_{run}.csv", frame(run).with_columns(pl.Series("time", range(N))))
    assert [loop.tag for loop in open_plant(tmp_path).loops()] == ["FIC101_1", "FIC101_2"]


def test_one_tag_twice_is_said_with_both_files(tmp_path):
    put(tmp_path / "a.csv", side_by_side())
    put(tmp_path / "b.csv", side_by_side().with_columns(pl.col("FIC101.OP") + 1.0))
    put(tmp_path / "c.csv", frame(0))
    plant = open_plant(tmp_path)
    assert [loop.tag for loop in plant.loops()] == ["c"]
    assert len(plant.unread()) == 3
    assert all(one.failed and "a.csv" in one.where and "b.csv" in one.where for one in plant.unread())
    assert all("loop list" in one.why for one in plant.unread())


def test_a_copy_counts_once(tmp_path):
    put(tmp_path / "FIC101.csv", frame(0))
    put(tmp_path / "copy" / "FIC101.csv", frame(0))
    plant = open_plant(tmp_path)
    assert [loop.tag for loop in plant.loops()] == ["FIC101"]
    assert [(one.failed, "the same as" in one.why) for one in plant.unread()] == [(False, True)]


def test_what_holds_no_loop_is_said(tmp_path):
    put(tmp_path / "FIC101.csv", frame(0))
    (tmp_path / "README.txt").write_text("Records of unit 1.\n")
    (tmp_path / "report.html").write_text("<html></html>")
    (tmp_path / "labels.csv").write_text("loop,label\nFIC101,stiction\nFIC102,none\n")
    (tmp_path / "broken.parquet").write_bytes(b"PAR1 and no more")
    (tmp_path / "empty.csv").write_text("")
    (tmp_path / "rig.csv").write_text("time,volt,rpm\n" + "".join(f"{k},{k % 7},{k % 5}\n" for k in range(99)))
    (tmp_path / ".hidden.csv").write_text("x")
    plant = open_plant(tmp_path)
    assert [loop.tag for loop in plant.loops()] == ["FIC101"]
    told = {one.where: one for one in plant.unread()}
    assert {where: one.failed for where, one in told.items()} == {
        "README.txt": False, "report.html": False, "labels.csv": False, "broken.parquet": True, "empty.csv": True,
        "rig.csv": True,
    }  # fmt: skip
    assert "op=volt, pv=rpm" in told["rig.csv"].why
    assert all("\n" not in one.why for one in plant.unread())


def socket_at(path):
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(str(path))


ODD = {
    "pipe.csv": (os.mkfifo, "no file"),
    "pipe.parquet": (os.mkfifo, "no file"),
    "part-0.parquet": (os.mkfifo, "no file"),
    "FIC9_OP.csv": (os.mkfifo, "no file"),
    "readme.txt": (os.mkfifo, "no file"),
    "socket.csv": (socket_at, "no file"),
    "device.csv": (lambda path: path.symlink_to("/dev/zero"), "a link that leads to no file"),
    "absent.csv": (lambda path: path.symlink_to("nowhere"), "a link that leads to no file"),
    "circle.csv": (lambda path: path.symlink_to("circle.csv"), "a link that leads to no file"),
    "above.csv": (lambda path: path.symlink_to("."), "a link to a folder"),
    "link": (lambda path: path.symlink_to(".."), "a link to a folder"),
}


@pytest.mark.parametrize("form", ["{}", "{}/*", "{}/**", "{}/**/*"])
def test_what_is_no_file_is_listed_as_unread(tmp_path, form):
    put(tmp_path / "here" / "FIC101.csv", frame(0))
    for name, (make_odd, _) in ODD.items():
        make_odd(tmp_path / "here" / name)
    plant = open_plant(form.format(tmp_path))
    loops = plant.loops()
    assert [loop.tag for loop in loops] == ["FIC101"]
    assert isinstance(records(plant)["FIC101"], LoopRecord)
    assert [loop.tag for loop in propose(plant)] == ["FIC101"]
    told = {one.where.removeprefix("here/"): one.why for one in plant.unread()}
    for name, (_, why) in ODD.items():
        assert why in told[name], name
    assert all(one.failed for one in plant.unread())


SECRET = "secret;of;root\nhunter2;x;y\n"


@pytest.fixture
def plant_and_secret(tmp_path):
    """A plant folder beside a file that is nobody's business."""
    put(tmp_path / "plant" / "FIC101.csv", frame(0))
    put(tmp_path / "plant" / "sub" / "FIC102.csv", frame(1))
    (tmp_path / "secret.txt").write_text(SECRET)
    (tmp_path / "plant" / "up").symlink_to("..")
    (tmp_path / "plant" / "inner.csv").symlink_to("sub/FIC102.csv")
    (tmp_path / "plant" / "secret.csv").symlink_to("../secret.txt")
    return tmp_path / "plant"


@pytest.mark.parametrize(
    "file", ["/etc/passwd", "../secret.txt", "sub/../../secret.txt", "secret.csv", "up/secret.txt", "{}/secret.txt"]
)
@pytest.mark.parametrize("form", ["{}", "{}/*.csv", "{}/FIC101.csv"])
def test_a_loop_list_reaches_only_what_was_given(plant_and_secret, file, form):
    """Else whoever sends a list has any file quoted in the report."""
    where = file.format(plant_and_secret.parent)
    listed = [PlantLoop("A", op="OP", pv="PV", where=where), PlantLoop("FIC101", where="FIC101.csv")]
    plant = open_plant(form.format(plant_and_secret), loops=listed)
    assert [loop.tag for loop in plant.loops()] == ["FIC101"]
    said = {one.where: one.why for one in plant.unread()}
    assert "leads out of what was given" in said["A"]
    assert not any(word in text for word in ("hunter2", "secret;of", "root:") for text in said.values())


def test_what_is_given_too_is_read(plant_and_secret):
    listed = [PlantLoop("A", op="OP", pv="PV", where=str(plant_and_secret / "sub" / "FIC102.csv"))]
    for sources in (plant_and_secret, [plant_and_secret / "FIC101.csv", plant_and_secret / "sub"]):
        assert [loop.tag for loop in open_plant(sources, loops=listed).loops()] == ["A"]


@pytest.mark.parametrize("form", ["{}", "{}/*.csv"])
def test_a_link_in_a_folder_leads_not_out_of_it(plant_and_secret, form):
    plant = open_plant(form.format(plant_and_secret))
    told = {one.where: one.why for one in plant.unread()}
    assert "leads out of what was given" in told["secret.csv"]
    assert not any("hunter2" in text or "secret;of" in text for text in told.values())
    assert "inner.csv" not in told or "leads out" not in told["inner.csv"]
    assert [one.tag for one in open_plant(plant_and_secret / "inner.csv").loops()] == ["inner"]


def test_links_that_lead_in_circles_have_an_end(tmp_path):
    put(tmp_path / "FIC101.csv", frame(0))
    for name in "abc":
        (tmp_path / name).symlink_to(".")
    for pattern in ("**/*.csv", "**/**/*.csv", "**"):
        assert [loop.tag for loop in open_plant(tmp_path / pattern).loops()] == ["FIC101"]


def test_folders_of_any_depth(tmp_path):
    put(tmp_path / "FIC101.csv", frame(0))
    here = os.open(tmp_path, os.O_RDONLY)
    try:
        for _ in range(3000):  # deeper than a path can be written
            os.mkdir("d", dir_fd=here)
            below = os.open("d", os.O_RDONLY, dir_fd=here)
            os.close(here)
            here = below
        plant = open_plant(tmp_path)
        assert [loop.tag for loop in plant.loops()] == ["FIC101"]
        assert [one.why for one in plant.unread()] == ["it is gone, or its path is too long"]
    finally:
        os.close(here)  # and what Python, pytest too, would recurse over when it removes it
        subprocess.run(["rm", "-rf", str(tmp_path / "d")], check=True)  # noqa: S607


def test_errors_are_values_of_one_loop(tmp_path):
    source, _ = make("files csv", tmp_path)
    plant = open_plant(source)
    loops = plant.loops()
    (tmp_path / "unit 1" / "LIC102.csv").write_text("time,OP,PV\n0,1,x\n1,y,3\n")
    (tmp_path / "unit 1" / "PIC103.csv").unlink()
    found = records(plant, loops)
    assert isinstance(found["FIC101"], LoopRecord)
    assert isinstance(found["LIC102"], LostMotionError)
    assert isinstance(found["PIC103"], FileAccessError)


def test_a_loop_without_data_is_an_error_of_its_own(tmp_path):
    source, _ = make("files csv", tmp_path)
    assert "no file" in str(records(open_plant(source), [PlantLoop("X")])["X"])


def test_nothing_there(tmp_path):
    with pytest.raises(FileAccessError, match="none in the folder"):
        open_plant(tmp_path)
    with pytest.raises(FileAccessError, match="no such file"):
        open_plant(tmp_path / "absent")
    with pytest.raises(FileAccessError, match="none like"):
        open_plant(tmp_path / "*.csv")
    with pytest.raises(InputError, match="paths, or records"):
        open_plant([1, 2])
    with pytest.raises(ParameterError, match=r"got loop=\.\.; give it in a loop list"):
        open_plant(tmp_path, loop="FIC101")
    with pytest.raises(ParameterError, match="a query of a database only"):
        open_plant(tmp_path, query="SELECT 1")


def test_patterns_and_lists(tmp_path):
    make("files csv", tmp_path)
    assert len(open_plant(tmp_path / "unit 1" / "*IC10[12].csv").loops()) == 2
    both = open_plant([tmp_path / "unit 1" / "FIC101.csv", tmp_path / "unit 1" / "LIC102.csv"])
    assert [loop.tag for loop in both.loops()] == ["FIC101", "LIC102"]
    assert len(records(both)["LIC102"]) == N


def test_settings_of_all_loops(tmp_path):
    put(tmp_path / "a.csv", frame(0).rename({"OP": "valve", "PV": "flow"}).drop("time"))
    (loop,) = open_plant(tmp_path, op="valve", pv="flow", dt=2.0).loops()
    assert loop.op == "valve"
    assert records(open_plant(tmp_path, op="valve", pv="flow", dt=2.0))["a"].dt == 2.0


def test_roles_in_a_folder_of_the_tag(tmp_path):
    for role in ("OP", "PV"):
        put(tmp_path / "FIC101" / f"{role}.csv", frame(0).select("time", pl.col(role).alias("value")))
    (loop,) = open_plant(tmp_path).loops()
    assert loop.tag == "FIC101"
    np.testing.assert_array_equal(records(open_plant(tmp_path))["FIC101"].op, signals(0)["OP"])


def test_records_that_were_read_are_not_kept(tmp_path):
    n, loops = 5_000, 40
    row = {"time": pl.int_range(0, n, eager=True), "OP": np.arange(n) % 97 * 1.0, "PV": np.arange(n) % 89 * 1.0}
    table = pl.concat([pl.DataFrame({"tag": [f"FIC{k:03d}"] * n, **row}) for k in range(loops)])
    table.write_parquet(tmp_path / "plant.parquet", row_group_size=n)
    size = table.estimated_size()
    del table
    plant = open_plant(tmp_path / "plant.parquet")
    known = plant.loops()
    list(plant.read(known[:1]))
    tracemalloc.start()
    count = sum(len(record) == n for _, record in plant.read(known))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert count == loops
    assert peak < 0.3 * size


def test_rows_of_many_loops_hold_the_order_of_their_own(tmp_path):
    mixed = below_each_other().sort("time", "tag")
    found = records(open_plant(put(tmp_path / "mixed.parquet", mixed)))
    np.testing.assert_array_equal(found["PIC103"].op, signals(2)["OP"])


@pytest.mark.parametrize(
    "sign", ["\x1b", "\n", "\r", "\t", "\x7f", "\x9b", "\u202e", "\udce9", "\U000e0041", "%", "%u001b"]
)
def test_addresses_of_any_name_can_be_shown(sign):
    places = (Place((f"a{sign}.csv", "b.csv"), f"L{sign}"), Place((f"{sign}{sign}c",)))
    line = written(places)
    assert line.isprintable()
    assert parsed(line) == places


def test_addresses():
    assert parsed("50%U00110000%u00.csv") == (Place(("50%U00110000%u00.csv",)),)
    places = (Place(("a|b&c#d%.csv", "e\nf.csv"), "x#y"), Place(("unit 1/g.csv",)))
    assert parsed(written(places)) == places
    assert "\n" not in written(places)


def test_records_of_other_rates_and_repeated_ones_are_left_out():
    def record(day, number, dt=1.0):
        made = {role.lower(): values for role, values in signals(number).items()}
        return LoopRecord(**made, dt=dt, start=START + timedelta(days=day), source=f"day {day}")

    whole = pooled([record(2, 2), record(0, 0), record(1, 1, dt=5.0), record(3, 0)])
    assert len(whole) == 2 * N
    assert any("day 1 (every 5 s)" in note for note in whole.notes)
    assert any("day 3" in note and "those of another record" in note for note in whole.notes)
    with pytest.raises(DataError, match="records of one loop with dates"):
        pooled([record(0, 0), replace(record(1, 1), start=None)])
    assert START.tzinfo is UTC


def unbroken(moments):
    return pl.DataFrame({"time": moments, **signals(0, len(moments))})


@pytest.mark.parametrize(
    ("change", "read"),
    [
        (lambda rows: rows, 40),
        (lambda rows: rows.with_columns(pl.col("time").dt.replace_time_zone(None)), 40),
        (lambda rows: rows.with_columns(pl.col("time").dt.convert_time_zone("Asia/Tokyo")), 40),
        (lambda rows: rows.with_columns(mode=pl.Series(["AUTO", *[None] * (N - 1)])), N),
        (lambda rows: rows.with_columns(time=pl.col("time") + pl.duration(milliseconds=pl.col("PV").round() * 7)), N),
        (lambda rows: rows.with_columns(pl.col("time").dt.to_string("%Y-%m-%d %H:%M:%S")), N),
    ],
)
def test_of_parquet_only_the_rows_of_the_time_are_read(tmp_path, monkeypatch, change, read):
    rows = change(unbroken([START + timedelta(seconds=k) for k in range(N)]))
    rows.write_parquet(tmp_path / "FIC101.parquet", row_group_size=20)
    since, until = START + timedelta(seconds=60), START + timedelta(seconds=100)
    taken, table_of = [], files_source.table_of

    def watched(*given, **more):
        taken.append(table_of(*given, **more))
        return taken[-1]

    monkeypatch.setattr(files_source, "table_of", watched)
    found = records(open_plant(tmp_path), since=since, until=until)["FIC101"]
    monkeypatch.setattr(Period, "of", lambda *given: None)
    whole = records(open_plant(tmp_path), since=since, until=until)["FIC101"]
    assert [table.frame.shape[0] for table in taken] == [read, N]
    for name in ("fingerprint", "start", "dt", "notes"):
        assert getattr(found, name) == getattr(whole, name)


def test_of_parquet_with_nothing_of_the_time_the_error_is_that_of_all(tmp_path):
    unbroken([START + timedelta(seconds=k) for k in range(N)]).write_parquet(tmp_path / "FIC101.parquet")
    found = records(open_plant(tmp_path), since=START + timedelta(days=9))["FIC101"]
    assert "rows of 2026-03-10" in str(found)
