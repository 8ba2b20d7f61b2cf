"""Every public function that takes a record takes whatever holds one: the table below is all of them."""

import inspect

import numpy as np
import pandas as pd
import polars as pl
import pytest

import lostmotion as lm
from lostmotion import records
from lostmotion.errors import InputError, LostMotionError, ParameterError
from lostmotion.plant import open_plant

ROWS = 400
RNG = np.random.default_rng(5)
OP = 50.0 + np.repeat(RNG.normal(scale=5.0, size=ROWS // 8), 8)
PROCESS = lm.LinearModel([-0.8], [0.2], 1)
PV = PROCESS.simulate(OP - 50.0) + 50.0 + RNG.normal(scale=0.02, size=ROWS)
COLUMNS = {"t_s": np.arange(float(ROWS)), "OP": OP, "PV": PV, "SP": np.full(ROWS, 50.0)}
RENAMED = {"stamp": COLUMNS["t_s"], "U": OP, "Y": PV}
NAMES = {"op": "U", "pv": "Y", "time": "stamp"}
RECORD = lm.LoopRecord(OP, PV, COLUMNS["SP"], dt=1.0)
MODEL = lm.Hammerstein(lm.DeadZone(-1.0, 1.0), PROCESS, 50.0)
ESTIMATE = {"nonlinearity": "none", "orders": (1, 0, 1), "noise": "white"}


@pytest.fixture(scope="module")
def fit():
    return lm.identify(RECORD, **ESTIMATE)


def study(fit, record):
    found = lm.compensation_study(
        MODEL, lm.PI(0.5, 0.05), record=record, noise=1e-4, runs=1, draws=0, cycle_samples=300, accept="a test"
    )
    return found.described, found.cases["with"].ratio


# what each makes of a record, as plain values
FUNCTIONS = {
    "achievable": lambda fit, record: lm.achievable(record, MODEL, 0.01).expected,
    "actuator_response": lambda fit, record: lm.actuator_response(record).to_dict(),
    "check": lambda fit, record: lm.check(record).to_dict()["loop"],
    "compensation_study": study,
    "diagnose": lambda fit, record: lm.diagnose(record).to_dict()["verdict"],
    "fit.predict": lambda fit, record: fit.predict(record).tolist()[1:],
    "fit.simulate": lambda fit, record: fit.simulate(record).tolist()[1:],
    "identify": lambda fit, record: lm.identify(record, **ESTIMATE).parameters,
    "records.as_record": lambda fit, record: records.as_record(record).fingerprint,
    "records.prepare": lambda fit, record: records.prepare(record).rows,
    "records.resample": lambda fit, record: records.resample(record, 2).fingerprint,
    "solve": lambda fit, record: [step.said for step in lm.solve(record).steps],
}
NAMING = {
    "check": lambda record, **names: lm.check(record, **names).sampling,
    "diagnose": lambda record, **names: lm.diagnose(record, **names).verdict,
    "identify": lambda record, **names: lm.identify(record, **ESTIMATE, **names).parameters,
    "solve": lambda record, **names: lm.solve(record, **names).outcome,
}


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    path = tmp_path_factory.mktemp("record") / "loop.csv"
    frame = pl.DataFrame(COLUMNS)
    frame.write_csv(path)
    return {
        "path": path,
        "text": str(path),
        "pandas": pd.DataFrame(COLUMNS),
        "polars": frame,
        "arrow": frame.to_arrow(),
        "dict": {name: list(values) for name, values in COLUMNS.items()},
        "dict of arrays": COLUMNS,
        "list of one": [RECORD],
        "list of one dict": [COLUMNS],
    }


KINDS = ("path", "text", "pandas", "polars", "arrow", "dict", "dict of arrays", "list of one", "list of one dict")


@pytest.fixture(scope="module")
def expected(fit):
    return {name: call(fit, RECORD) for name, call in FUNCTIONS.items()}


@pytest.mark.sampled(29)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_record_in_any_form(fit, sources, expected, name, kind):
    if name == "diagnose" and kind not in ("path", "dict"):
        pytest.skip("as the others, at ten times the time")
    found = FUNCTIONS[name](fit, sources[kind])
    assert str(found) == str(expected[name])


def test_the_table_is_all_of_them():
    rooms = [(lm, "", lm.__all__), (records, "records.", set(records.__all__) - set(lm.__all__))]
    public = {prefix + name: getattr(room, name) for room, prefix, names in rooms for name in names}
    takes = {name for name, value in public.items() if inspect.isfunction(value) and takes_records(value)}
    assert takes | {"fit.predict", "fit.simulate", "records.as_record"} == set(FUNCTIONS)


def takes_records(function):
    return any("Record" in str(one.annotation) for one in inspect.signature(function).parameters.values())


@pytest.mark.parametrize("name", NAMING)
def test_columns_by_their_names(name):
    call = NAMING[name]
    assert str(call(RENAMED, **NAMES)) == str(call(lm.read_loop(pd.DataFrame(RENAMED), **NAMES)))
    untimed = {"OP": OP, "PV": PV}
    assert str(call(untimed, dt=1.0)) == str(call(lm.LoopRecord(OP, PV, dt=1.0)))
    with pytest.raises(ParameterError, match=r"expected a path, a data frame or a dict beside op, got LoopRecord"):
        call(RECORD, op="U")
    with pytest.raises(ParameterError, match="as in the record"):
        call(RECORD, dt=2.0)


def test_no_columns_of_arrays():
    with pytest.raises(ParameterError, match="beside op, got ndarray"):
        lm.identify(OP, PV, 1.0, op="U")


def test_lists():
    several = [{"OP": OP[:200], "PV": PV[:200]}, {"OP": OP[200:], "PV": PV[200:]}]
    parts = [lm.LoopRecord(OP[:200], PV[:200], dt=1.0), lm.LoopRecord(OP[200:], PV[200:], dt=1.0)]
    for given in (several, [parts[0], several[1]]):
        assert lm.identify(given, dt=1.0, **ESTIMATE).parameters == lm.identify(parts, **ESTIMATE).parameters
    with pytest.raises(InputError, match=r"expected one record, got 2 records; give them one by one"):
        lm.check(several, dt=1.0)


@pytest.mark.parametrize("call", [lm.check, lm.solve, records.prepare, lm.diagnose])
@pytest.mark.parametrize("given", [OP, 3.0, None, [1.0, 2.0], records.prepare(RECORD)], ids=repr)
def test_what_holds_no_record(call, given):
    with pytest.raises(InputError, match=r"expected a record: a LoopRecord, path, data frame or dict of columns"):
        call(given)


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({}, "columns by their names"),
        ({1: [2.0, 3.0]}, "columns by their names"),
        ({"OP": [1.0, 2.0], "PV": [1.0]}, "got OP 2, PV 1"),
        ({"OP": 1.0, "PV": [1.0]}, "OP with one value a row"),
        ({"OP": [1.0, 2.0], "PV": np.zeros((2, 2))}, "PV with one value a row"),
        ({"X": [1.0, 2.0], "PV": [1.0, 2.0]}, "name it with op='<column>'"),
        ({"OP": [1.0, "x"], "PV": [1.0, 2.0]}, "OP"),
    ],
)
def test_dicts_that_are_no_table(columns, message):
    with pytest.raises(LostMotionError, match=message):
        lm.check(columns, dt=1.0)


@pytest.mark.parametrize(
    "times", [np.arange("2026-03-01", "2026-03-11", dtype="M8[D]"), pd.date_range("2026", periods=10)]
)
def test_dict_with_dates(times):
    record = lm.read_loop({"time": times, "OP": pd.Series(range(10)), "PV": range(10)})
    assert record.start.year == 2026
    assert record.dt == 86400.0


def test_a_plant_of_anything(sources):
    plant = open_plant({"FIC-1": sources["pandas"], "FIC-2": sources["path"], "FIC-3": RECORD})
    assert [record.fingerprint for _, record in plant.read(plant.loops())] == [RECORD.fingerprint] * 3
