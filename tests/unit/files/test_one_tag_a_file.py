"""Files of one tag each: joined to one record, each tag at times of its own."""

import datetime as dt
import shlex

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ColumnError, DataError, FileAccessError, InputError, TimeError
from tests.e2e.test_commands import run

N = 300
PV = np.round(50 + 5 * np.sin(np.arange(N) / 9) + np.arange(N) % 3, 2)
OP = np.round(np.repeat(np.random.default_rng(1).normal(40, 5, N // 5), 5), 2)
START = dt.datetime(2024, 3, 14, 8)
DAY_FIRST = "%d.%m.%Y %H:%M:%S"


def stamp(second, form="%Y-%m-%d %H:%M:%S"):
    return (START + dt.timedelta(seconds=float(second))).strftime(form)


def write(path, seconds, values, head="Timestamp,Value", form="%Y-%m-%d %H:%M:%S", more=""):
    rows = [f"{stamp(second, form)},{value}{more}" for second, value in zip(seconds, values, strict=True)]
    path.write_text("\n".join([head, *rows, ""]))
    return path


def changes(values):
    return np.flatnonzero(np.r_[True, np.diff(values) != 0])


@pytest.fixture
def folder(tmp_path):
    """OP stored when it moves, PV every second, SP at both ends."""
    where = tmp_path / "FIC101"
    where.mkdir()
    moved = changes(OP)
    write(where / "FIC101_OP.csv", moved, OP[moved])
    write(where / "FIC101_PV.csv", np.arange(N), PV)
    write(where / "FIC101_SP.csv", [0, N - 1], [50, 50])
    return where


def assert_whole(record):
    np.testing.assert_array_equal(record.op, OP)
    np.testing.assert_array_equal(record.pv, PV)
    assert (record.dt, record.tag, record.loop_type, record.gaps) == (1.0, "FIC101", "flow", ())


def test_folder_list_and_pattern_are_one_record(folder):
    paths = sorted(folder.iterdir())
    for source in (folder, str(folder), paths, [str(path) for path in paths[::-1]], folder / "FIC101_*.csv"):
        record = lm.read_loop(source)
        assert_whole(record)
        np.testing.assert_array_equal(record.sp, np.full(N, 50.0))
        assert "Joined from 3 files of one tag each: FIC101_" in record.notes[0]
    assert lm.read_loop(paths[:2]).sp is None


@pytest.mark.parametrize("share", [0.6, 0.9])
def test_held_where_the_rows_are_samples_already(folder, share):
    stored = np.flatnonzero((np.random.default_rng(2).random(N) < share) | np.isin(np.arange(N), changes(OP)))
    write(folder / "FIC101_OP.csv", stored, OP[stored])
    record = lm.read_loop(folder)
    assert_whole(record)
    assert record.made_up[0] == pytest.approx(1 - len(stored) / N)
    assert "OP, SP filled between stored values" in " ".join(record.notes)


def test_bad_values_are_not_held_over(folder):
    path = write(folder / "FIC101_OP.csv", np.arange(N), OP, "Timestamp,Value,Quality", more=",Good")
    lines = path.read_text().splitlines()
    lines[8] = lines[8].replace("Good", "Bad")
    path.write_text("\n".join(lines))
    record = lm.read_loop(folder)
    assert np.flatnonzero(np.isnan(record.op)).tolist() == [7]


def test_one_clock_keeps_every_repair_of_times(folder):
    backwards = np.arange(N)[::-1]
    write(folder / "FIC101_OP.csv", backwards, OP[::-1])
    write(folder / "FIC101_PV.csv", backwards, PV[::-1])
    (folder / "FIC101_SP.csv").unlink()
    record = lm.read_loop(folder)
    assert_whole(record)
    assert record.made_up == (0.0, 0.0)


def test_order_of_day_and_month_is_told_by_any_file(folder):
    global START  # noqa: PLW0603
    was, START = START, dt.datetime(2024, 3, 12, 23, 58)
    try:
        moved = changes(OP)
        write(folder / "FIC101_OP.csv", moved[:3], OP[moved[:3]], form=DAY_FIRST)  # 12.03. only
        write(folder / "FIC101_PV.csv", np.arange(N), PV, form=DAY_FIRST)  # goes on to 13.03.
        write(folder / "FIC101_SP.csv", [0, N - 1], [50, 50], form=DAY_FIRST)
    finally:
        START = was
    record = lm.read_loop(folder)
    assert len(record) == N
    np.testing.assert_array_equal(record.op[:15], OP[:15])


def test_several_files_of_one_tag_are_one_behind_the_other(folder):
    write(folder / "FIC101_PV.csv", np.arange(150), PV[:150], "Time,FIC101.PV")
    write(folder / "later.csv", np.arange(140, N), PV[140:], "Time,FIC101.PV")  # they overlap
    write(folder / "FIC101_OP.csv", np.arange(N), OP, "Time,FIC101.OP")
    (folder / "FIC101_SP.csv").unlink()
    assert_whole(lm.read_loop(folder))


@pytest.mark.parametrize(
    ("names", "head"),
    [
        (("OP.csv", "PV.csv"), "time,value"),
        (("FV_101.csv", "FT_101.csv"), "time,value"),
        (("a.csv", "b.csv"), None),
        (("FIC101.OUT.csv", "FIC101.MEAS.csv"), "Zeit,Wert"),
        (("FIC101_OP.txt", "FIC101_PV.txt"), "Tag,Time,Value"),
    ],
)
def test_names_of_files_columns_and_tags(tmp_path, names, head):
    folder = tmp_path / "F101"
    folder.mkdir()
    for name, role, values in zip(names, ("OP", "PV"), (OP, PV), strict=True):
        path = write(folder / name, np.arange(N), values, head or f"Time,FIC101.{role}")
        if head == "Tag,Time,Value":
            lines = path.read_text().splitlines()
            path.write_text("\n".join([lines[0], *(f"FIC101.{role},{line}" for line in lines[1:]), ""]))
    record = lm.read_loop(folder)
    np.testing.assert_array_equal(record.op, OP)
    np.testing.assert_array_equal(record.pv, PV)
    assert record.tag in ("FIC101", "F101")


def test_several_loops_in_a_folder(capsys, folder):
    write(folder / "FIC102_OP.csv", np.arange(N), OP[::-1])
    write(folder / "FIC102_PV.csv", np.arange(N), PV[::-1])
    with pytest.raises(ColumnError, match="2 loops: FIC101, FIC102"):
        lm.read_loop(folder)
    assert_whole(lm.read_loop(folder, loop="FIC101"))
    np.testing.assert_array_equal(lm.read_loop(folder, loop="fic-102").pv, PV[::-1])
    assert "'FIC102'" in run(capsys, "check", folder, "--loop", "FIC102")[1]


def commands_of(error):
    return [shlex.split(line.strip())[1:] for line in error.splitlines() if line.startswith("    lostmotion")]


def test_two_files_that_could_be_op_are_refused_with_commands_that_work(capsys, folder):
    write(folder / "FIC101_OUT.csv", np.arange(N), OP)
    code, _, error = run(capsys, "check", folder)
    assert code == 1
    assert "one column for OP" in error
    commands = commands_of(error)
    assert len(commands) == 2
    for command in commands:
        assert run(capsys, *command)[2] == ""


def test_a_file_that_contradicts_its_name_is_refused_with_commands_that_work(capsys, folder):
    write(folder / "FIC101_OP.csv", np.arange(N), OP, "Time,PV")
    write(folder / "FIC101_PV.csv", np.arange(N), PV, "Time,OP")
    (folder / "FIC101_SP.csv").unlink()
    code, _, error = run(capsys, "check", folder)
    assert code == 1
    assert "PV in 'PV' and OP in 'FIC101_OP'" in error
    commands = commands_of(error)
    assert len(commands) == 2
    for command in commands:
        assert run(capsys, *command)[2] == ""
    np.testing.assert_array_equal(lm.read_loop(folder, op="FIC101_OP", pv="FIC101_PV").op, OP)


def test_tags_of_two_loops_are_not_put_together(capsys, tmp_path):
    write(tmp_path / "FIC101.csv", np.arange(N), OP, "Time,OP")
    write(tmp_path / "FIC102.csv", np.arange(N), PV, "Time,PV")
    code, _, error = run(capsys, "check", tmp_path)
    assert code == 1
    assert "OP and PV of one loop, got 'FIC101.OP' and 'FIC102.PV'" in error
    commands = commands_of(error)
    assert [command[2:] for command in commands] == [["--op", "FIC101.OP", "--pv", "FIC102.PV"]]
    assert run(capsys, *commands[0])[2] == ""
    (tmp_path / "FIC102.csv").rename(tmp_path / "FIC101 (2).csv")
    assert_whole(lm.read_loop(tmp_path))


def test_what_cannot_be_joined(folder, tmp_path):
    op = folder / "FIC101_OP.csv"
    with pytest.raises(ColumnError, match="the values of one tag; give the files of all tags"):
        lm.read_loop(op)
    with pytest.raises(FileAccessError, match="none like"):
        lm.read_loop(folder / "*.dat")
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileAccessError, match="none in the folder"):
        lm.read_loop(tmp_path / "empty")
    op.write_text("Value,Unit\n" + "".join(f"{value},%\n" for value in OP))
    with pytest.raises(TimeError, match=r"none in FIC101_OP\.csv"):
        lm.read_loop(folder)
    op.write_text("t_ms,Value\n" + "\n".join(f"{k},{v}" for k, v in enumerate(OP)) + "\n")
    with pytest.raises(TimeError, match="times of one kind"):
        lm.read_loop(folder)
    write(op, [0, 1, 1, 2], [1, 2, 3, 4])
    with pytest.raises(ColumnError, match="one value of a tag at a time"):
        lm.read_loop(folder)
    (folder / "whole.csv").write_text("t_s,OP,PV\n0,1,2\n1,2,3\n2,3,4\n")
    with pytest.raises(DataError, match=r"more than one tag in whole\.csv"):
        lm.read_loop(folder)


def test_without_times_dt_is_asked_for(folder):
    for name, values in (("OP", OP), ("PV", PV)):
        (folder / f"FIC101_{name}.csv").write_text("Value,Unit\n" + "".join(f"{value},%\n" for value in values))
    (folder / "FIC101_SP.csv").unlink()
    with pytest.raises(InputError, match="dt"):
        lm.read_loop(folder)
    assert_whole(lm.read_loop(folder, dt=1.0))


def test_times_without_a_common_rate_are_refused_with_a_command_that_works(capsys, folder):
    random = np.random.default_rng(4)
    for name, values, step in (("OP", OP, 2.0), ("PV", PV, 5.0)):
        write(
            folder / f"FIC101_{name}.csv",
            np.cumsum(random.uniform(0.5, 1.5, N)) * step,
            values,
            form="%Y-%m-%d %H:%M:%S.%f",
        )
    code, _, error = run(capsys, "check", folder)
    commands = commands_of(error)
    assert (code, [command[:-1] for command in commands]) == (1, [["check", str(folder), "--dt"]])
    assert float(commands[0][-1]) == pytest.approx(5.0, rel=0.1)  # that of PV, not of all rows
    assert run(capsys, *commands[0])[2] == ""


def test_check_of_the_files_is_one_record_and_its_next_command_works(capsys, folder):
    op, pv = folder / "FIC101_OP.csv", folder / "FIC101_PV.csv"
    for words in ((op, pv), (folder,), (folder / "FIC101_*.csv",)):
        code, text, error = run(capsys, "check", *words)
        assert (code, error) == (0, "")
        assert "loop 'FIC101', a flow loop by its tag: 300 samples of OP" in text
        following = shlex.split(text.splitlines()[-1].removeprefix("Next: lostmotion diagnose"))
        assert run(capsys, "check", *following)[1] == text


def test_whole_records_stay_one_result_each(capsys, tmp_path, folder):
    for name in ("FIC7", "FIC8"):
        (tmp_path / f"{name}.csv").write_text("t_s,OP,PV\n" + "".join(f"{k},{OP[k]},{PV[k]}\n" for k in range(N)))
    lines = run(capsys, "check", tmp_path / "FIC7.csv", tmp_path / "FIC8.csv")[1].splitlines()
    assert [line.split()[0] for line in lines[:2]] == ["FIC7", "FIC8"]
    tags = sorted(folder.iterdir())
    lines = run(capsys, "check", tmp_path / "FIC7.csv", *tags)[1].splitlines()
    assert [line.split()[0] for line in lines[:2]] == ["FIC7", "FIC101"]
    assert lines[-1].startswith("2 loops: ")
    assert run(capsys, "check", tmp_path / "FIC7.csv", tags[0])[1].splitlines()[-1].endswith("1 without a result.")


def test_a_list_of_the_files_is_one_record_for_every_function(folder):
    from lostmotion.records.as_record import as_records

    assert_whole(as_records(sorted(folder.iterdir())))


@pytest.mark.parametrize("comma", [False, True])
@pytest.mark.parametrize("heads", [("", ""), ("OP", "PV"), ("FIC101.OP [%]", "FIC101.PV [m3/h]")])
def test_one_number_a_line_needs_the_sampling_time_only(tmp_path, heads, comma):
    if comma and not heads[0]:
        pytest.skip("two columns without a header look the same")
    where = tmp_path / "FIC101"
    where.mkdir()
    for role, head, values in zip(("OP", "PV"), heads, (OP, PV), strict=True):
        lines = [str(value) for value in values]
        lines = [line.replace(".", ",") for line in lines] if comma else lines
        lines[-1] = "Bad" if role == "PV" else lines[-1]
        (where / f"FIC101_{role}.txt").write_text("\n".join([*([head] if head else []), *lines, ""]))
    with pytest.raises(TimeError, match="dt=<seconds>"):
        lm.read_loop(where)
    record = lm.read_loop(where, dt=2.0)
    np.testing.assert_array_equal(record.op, OP)
    np.testing.assert_array_equal(record.pv, np.r_[PV[:-1], np.nan])
    assert (record.dt, record.tag) == (2.0, "FIC101")


def test_one_number_a_line_is_not_shifted_by_a_blank_line(tmp_path):
    (tmp_path / "FIC101_OP.txt").write_text("1\n2\n3\n4\n")
    (tmp_path / "FIC101_PV.txt").write_text("1\n\n2\n3\n4\n")
    with pytest.raises(DataError, match="none in line 2"):
        lm.read_loop(tmp_path, dt=1.0)


def test_a_letter_is_called_none(tmp_path):
    file = tmp_path / "letter.csv"
    file.write_text("Dear colleague,\n\nplease find below our remarks on the loop.\n\nKind regards\n")
    with pytest.raises(
        DataError, match="expected a table with columns for OP and PV, got text such as 'Dear colleague,'"
    ):
        lm.read_loop(file)
