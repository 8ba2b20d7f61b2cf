import csv
import shlex

import numpy as np
import pytest

from lostmotion.errors import TimeError
from lostmotion.files import read_loop
from lostmotion.records import check
from tests.e2e.test_commands import run
from tests.support.shared_data import shared, shared_files

# dt in seconds that the provenance of the files gives, where the time column is not a clock
SACAC_DT = {
    "quantisation-F-minerals": 10.0,
    "saturation-L-minerals": 10.0,
    "stiction-P-oilgas": 12.0,
    "tuning-F-chemical-DB": 1.0,
    "stiction-L-paper-horch": 2.0,
    "other-F-chemicals-thornhill": 20.0,
    "saturation-T-oilgas-thornhill": 20.0,
    "sensor-F-oilgas-thornhill": 20.0,
    "stiction-L-chemicals-thornhill": 20.0,
}
MINUTE_STAMPS = (
    "quantisation-F-minerals",
    "saturation-L-minerals",
    "stiction-P-oilgas",
    "tuning-F-chemical-DB",
)
BROKEN = "tuning-L-paper-horch-2003"  # two recordings glued together


def isdb():
    with shared("isdb26/labels.csv").open(newline="") as stream:
        return {row["loop"]: row for row in csv.DictReader(stream)}


def assert_checked(record):
    report = check(record)
    assert record.tag in report.summary()
    assert report.sampling.missing == 0
    return report


CHEM = [1, 2, 3, 4, 5, 6, 10, 11, 12, 13, 14, 16, 23, 24, 26, 29, 32, 33, 34, 58]
ISDB_LOOPS = [*(f"CHEM{number}" for number in CHEM), "PAP2", "PAP4", "PAP5", "PAP7", "PAP9", "MIN1"]


@pytest.mark.parametrize("loop", ISDB_LOOPS)
def test_isdb_with_the_dt_of_the_labels(loop):
    row = isdb()[loop]
    path, dt = shared("isdb26") / row["file"], float(row["dt_s"])
    if loop in ("CHEM10", "CHEM11", "CHEM12"):  # the labels say 1 s, the time column 30 s
        with pytest.raises(TimeError, match=r"dt = 30 s as in column 'Time', got dt = 1 s"):
            read_loop(path, dt=dt)
        dt = 30.0
    record = read_loop(path, dt=dt)
    assert record.dt == dt
    assert record.sp is not None
    assert assert_checked(record).usable


@pytest.mark.parametrize("loop", ["CHEM23", "CHEM24", "CHEM10", "CHEM11", "CHEM12"])
def test_isdb_whose_times_disagree_needs_dt(loop):
    path = shared("isdb26") / isdb()[loop]["file"]
    with pytest.raises(TimeError, match="one sampling time") as caught:
        read_loop(path)
    assert [read_loop(path, **way).dt for way in caught.value.ways] == [way["dt"] for way in caught.value.ways]


@pytest.mark.parametrize("loop", ["PAP5", "PAP9"])
def test_isdb_whose_times_count_the_rows(loop):
    row = isdb()[loop]
    assert read_loop(shared("isdb26") / row["file"]).dt == float(row["dt_s"])


@pytest.mark.parametrize("path", shared_files("sacac/*-*.csv"), ids=lambda path: path.stem)
def test_sacac(path):
    path = shared(f"sacac/{path.name}")
    if path.stem == BROKEN:
        with pytest.raises(TimeError) as caught:
            read_loop(path)
        for way in caught.value.ways:
            assert "made up" in read_loop(path, **way).notes[-1]
        record = read_loop(path, dt=1.0, time=False)
    else:
        dt = next((value for start, value in SACAC_DT.items() if path.stem.startswith(start)), None)
        record = read_loop(path, dt=dt)
        assert dt in (None, record.dt)
    report = assert_checked(record)
    assert report.usable == (not path.stem.startswith("quantisation-F-minerals"))  # its OP is constant
    assert (max(report.loop.saturated_low, report.loop.saturated_high) > 0.1) == ("saturation" in path.stem)


@pytest.mark.parametrize("kind", MINUTE_STAMPS)
def test_sacac_minute_stamps_are_spread(kind):
    for path in shared_files(f"sacac/{kind}*.csv"):
        record = read_loop(shared(f"sacac/{path.name}"))
        assert record.dt == pytest.approx(SACAC_DT[kind], rel=0.05)
        assert any("spread evenly" in note for note in record.notes)


def test_damadics():
    path = shared("damadics/lublin_actuator3_2001-10-11_1h.csv")
    record = read_loop(path, op="LC74_20CV_pct", pv="LC74_20X_pct", op_span=(0, 100))
    assert (len(record), record.dt, record.sp) == (3600, 1.0, None)
    assert assert_checked(record).usable


def test_dcmotor():
    record = read_loop(shared("dcmotor/run_minimal.csv"), op="voltage", pv="rpm")
    assert (len(record), record.dt) == (6601, 0.01)
    assert "steps" in assert_checked(record).loop.mode


def test_cascaded_tanks():
    record = read_loop(shared("cascaded_tanks/dataBenchmark.csv"), op="uEst", pv="yEst")
    assert (len(record), record.dt) == (1024, 4.0)
    np.testing.assert_allclose(record.pv[:2], [5.205, 5.2154])
    assert assert_checked(record).usable


EVERY = [
    path
    for folder in (
        "isdb26",
        "isdb_more",
        "sacac",
        "refinery",
        "historian_week",
        "damadics",
        "dcmotor",
        "cascaded_tanks",
    )
    for path in shared_files(f"{folder}/*.csv")
    if path.name not in ("labels.csv", "index.csv")
]
REFUSED = {  # own columns that contradict each other, or names that tell no role
    *(f"CHEM{number}" for number in (8, 10, 11, 12, 23, 24, 39)), "BAS8", "stiction-L-paper-horch-2003", BROKEN,
    "LIC-106", "lublin_actuator3_2001-10-11_1h", "run_minimal", "dataBenchmark",
}  # fmt: skip


@pytest.mark.sampled(35)
@pytest.mark.parametrize("path", EVERY, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_as_it_comes_or_by_a_command_that_works(capsys, path):
    path = shared(f"{path.parent.name}/{path.name}")
    if path.stem not in REFUSED:
        assert read_loop(path).dt > 0
        return
    error = run(capsys, "check", path)[2]
    commands = [line.strip() for line in error.splitlines()[1:]]
    assert commands
    for command in commands:
        assert run(capsys, *shlex.split(command)[1:])[2] == "", command
