"""Wide tables: thousands of loops beside each other are found, and read one by one in a time linear in their number."""

import lostmotion as lm
from lostmotion.files import opened as opened_module
from lostmotion.files.every_loop import read_loops
from lostmotion.files.frames import FEWEST_LINES, PEEKED, peeked
from lostmotion.files.narrowed import columns_to_read
from lostmotion.files.tags import tag_and_role


def wide(loops, rows=5):
    """Text of a table with so many loops; value of loop k in row r: k + r."""
    head = ",".join(f"FIC{k}.PV,FIC{k}.OUT" for k in range(loops))
    return "\n".join(
        [f"t_s,{head}", *(f"{r}," + ",".join([f"{k + r},{r}" for k in range(loops)]) for r in range(rows))]
    )


def test_the_columns_of_a_loop_and_what_loops_share():
    names = ["Time", "FC1.PV", "FC1.PV.Status", "FC1.OUT", "FC2.PV", "FC2.OUT", "note", "TI3.PV"]
    found = columns_to_read(names)
    assert found["FC1"] == ["Time", "FC1.PV", "FC1.PV.Status", "FC1.OUT", "note"]
    assert found["FC2"] == ["Time", "FC2.PV", "FC2.OUT", "note"]


def test_columns_of_quality_by_place_need_the_whole_table():
    assert columns_to_read(["t", "F1.PV", "Quality", "F1.OUT", "quality", "F2.PV", "F2.OUT"]) == {}


def test_each_loop_is_that_of_read_loop(tmp_path):
    path = tmp_path / "a.csv"
    head = "t_s,F1.PV,F1.PV.Status,F1.OUT,F2.PV,F2.OUT,F2.SP\n"
    path.write_text(head + "".join(f"{r},{r},{'Good' if r != 3 else 'Bad'},1,{2 * r},5,7\n" for r in range(9)))
    for tag, record in read_loops(path).items():
        alone = lm.read_loop(path, loop=tag)
        assert (record.pv[~(record.pv != record.pv)] == alone.pv[~(alone.pv != alone.pv)]).all()
        assert record.notes == alone.notes


def test_columns_that_are_looked_at_are_linear_in_their_number(tmp_path, monkeypatch):
    path, seen = tmp_path / "a.csv", []
    path.write_text(wide(300))
    plain = opened_module.replace

    def counted(one, **changes):
        if "frame" in changes:
            seen.append(len(changes["frame"].columns))
        return plain(one, **changes)

    monkeypatch.setattr(opened_module, "replace", counted)
    records = read_loops(path)
    assert len(records) == 300
    assert records["FIC7"].pv.tolist() == [7.0, 8.0, 9.0, 10.0, 11.0]
    assert seen == [3] * 300  # before, each loop looked at all 601


def test_a_header_longer_than_what_is_peeked_at(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text(wide(6000, rows=40))
    assert path.read_text().index("\n") > PEEKED
    table = peeked(path)
    assert len(table.frame) >= FEWEST_LINES - 1
    assert tag_and_role(table.names[-1]) == ("FIC5999", "op")
