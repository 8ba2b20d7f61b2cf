"""The real records as one plant: every file accounted for, each loop as an engineer would call it."""

from lostmotion.errors import TimeError
from lostmotion.plant import open_plant
from lostmotion.plant.address import parsed
from lostmotion.records import LoopRecord
from tests.support.shared_data import shared

SEVERAL = {"2411FIC20102": 23, "2111LIC31102B": 9, "2111LIC33102": 4, "2411PDIC10321": 2, "2111FIC40102E": 2}


def test_all_folders_as_one_plant():
    folder = shared("README.md").parent
    plant = open_plant(folder)
    loops, unread = plant.loops(), plant.unread()
    used = {file: loop for loop in loops for place in parsed(loop.where) for file in place.files}
    there = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert used.keys() | {one.where for one in unread} == there
    assert not used.keys() & {one.where for one in unread}
    assert len({loop.tag for loop in loops}) == len(loops)
    records = {tag: len(parsed(loop.where)) for tag, loop in ((loop.tag, loop) for loop in loops)}
    assert SEVERAL.items() <= records.items()
    assert {loop.area for loop in loops} <= {path.name for path in folder.iterdir()}
    failed = {one.where for one in unread if one.failed}
    assert all(where.endswith(".csv") and "label" not in where and "index" not in where for where in failed)
    assert "historian_week/LIC-106.csv" in failed  # PV of one number and OP of another: a person has to say it

    found = dict(plant.read([loop for loop in loops if loop.area in ("refinery", "isdb26")]))
    told = {loop.tag: record for loop, record in found.items()}
    assert told["2411FIC20102"].start.year == 2024
    assert len(told["2411FIC20102"].gaps) == 20  # 23 records, of which two repeat the end of the one before
    assert told["2411FIC20102"].loop_type == "flow"
    errors = {tag: record for tag, record in told.items() if not isinstance(record, LoopRecord)}
    assert all(isinstance(error, TimeError) for error in errors.values())  # times that contradict each other
    assert set(errors) <= {"CHEM10", "CHEM11", "CHEM12", "CHEM23", "CHEM24"}


def test_a_contradiction_of_times_is_settled_in_the_loop_list(tmp_path):
    folder = shared("isdb26/CHEM12.csv").parent
    (tmp_path / "loops.csv").write_text("tag,file,dt\nCHEM12,CHEM12.csv,30\n")
    plant = open_plant(folder, tmp_path / "loops.csv")
    ((loop, record),) = plant.read(plant.loops())
    assert (loop.tag, record.dt) == ("CHEM12", 30.0)
