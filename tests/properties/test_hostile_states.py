"""State files with one value changed and signed anew: each start gives the one error or works, and none dies."""

import json
import subprocess
import sys

import numpy as np
import pytest

from lostmotion.errors import DataError, LostMotionError
from lostmotion.identify import RecursiveML
from lostmotion.online import monitor
from lostmotion.online.packing import STATE, unpack
from tests.support import state_of_online as online
from tests.support.hostile_values import archived, array_mutant, changed, mutants, signed, unarchived, unsigned

KIND, INNER = STATE, monitor.KIND


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    """State after 1,500 of 1,800 rows, and the record."""
    folder = tmp_path_factory.mktemp("saved")
    text = online.rows(1800)
    record, state = folder / "record.csv", folder / "base"
    record.write_text("".join(text.splitlines(keepends=True)[:1501]))
    online.start(record, state)
    record.write_text(text)
    return state.read_bytes(), text


def parts(data):
    """Header of the state, header of the monitor, header of the estimator, its arrays."""
    head, blob = unsigned(KIND, data)
    inner, estimator = unsigned(INNER, blob)
    arrays = unarchived(estimator)
    return head, inner, json.loads(arrays["header"].tobytes()), arrays


def whole(head, inner, own, arrays):
    header = np.frombuffer(json.dumps(own).encode("utf-8", "surrogatepass"), dtype=np.uint8)
    return signed(KIND, head, signed(INNER, inner, archived({**arrays, "header": header})))


def sample(data, share, arrays_each, seed):
    """Some of all changed states."""
    head, inner, own, arrays = parts(data)
    chance = numbers = np.random.default_rng(seed)
    yield from (whole(made, inner, own, arrays) for made in mutants(head, chance, share))
    yield from (whole(head, made, own, arrays) for made in mutants(inner, chance, share))
    yield from (whole(head, inner, made, arrays) for made in mutants(own, chance, share))
    for name in sorted(arrays.keys() - {"header"}):
        for _ in range(arrays_each):
            yield whole(head, inner, own, {**arrays, name: array_mutant(arrays[name], numbers)})


def started(folder, states, text):
    """Lines "FILE outcome" of a process of its own."""
    (folder / "record.csv").write_text(text)
    for number, state in enumerate(states):
        (folder / f"{number:05d}.state").write_bytes(state)
    command = [sys.executable, "-W", "error::RuntimeWarning", "-m", "tests.support.state_of_online", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=500)
    assert done.returncode == 0, f"{done.returncode} after {done.stdout.splitlines()[-1:]}: {done.stderr[-500:]}"
    return done.stdout.splitlines()[:-1]


@pytest.mark.long
def test_a_sample_of_changed_states(saved, tmp_path):
    data, text = saved
    states = [whole(*parts(data)), *sample(data, 0.01, 6, seed=1)]
    said = started(tmp_path, states, text)
    assert len(said) == len(states) > 60
    assert said[0].endswith("works")
    assert [line for line in said if not line.endswith(("works", "one line"))] == []


WRONG = [
    (("position", "grid", "clock"), [0.0], "grid.clock"), (("position", "layout", "dt"), 0.0, "dt"),
    (("position", "layout", "op"), "none", "columns"), (("position", "offset"), 10**18, "offset"),
    (("settings",), 3, "settings"), (("position", "mark", "offset"), 3, "mark"),
]  # fmt: skip


@pytest.mark.parametrize(("place", "value", "named"), WRONG)
def test_what_is_wrong_is_named(saved, tmp_path, place, value, named):
    data, text = saved
    head, inner, own, arrays = parts(data)
    (tmp_path / "record.csv").write_text(text)
    (tmp_path / "a.state").write_bytes(whole(changed(head, place, value), inner, own, arrays))
    with pytest.raises(DataError, match=named):
        online.start(tmp_path / "record.csv", tmp_path / "a.state")


def test_headers_that_are_no_json_of_ours():
    for text in (
        b"[" * 100_000,
        b"1" * 5000,
        b'{"a": NaN}',
        b'{"a": 1e999}',
        b"[]",
        b"",
        b"\xff",
        b'{"a":' * 50 + b"1",
    ):
        with pytest.raises(DataError):
            unpack(KIND, signed(KIND, text, b""))
    long = signed(KIND, {}, b"")
    with pytest.raises(LostMotionError):
        unpack(KIND, long[: len(KIND) + 1] + b"\xff" * 8 + long[len(KIND) + 9 :])


@pytest.mark.parametrize("name", ["na", "nb", "delay", "noise", "start_samples"])
def test_settings_that_ask_for_any_memory_are_refused(saved, name):
    *_, own, arrays = parts(saved[0])
    header = json.dumps(changed(own, ("settings", name), 2**62)).encode()
    with pytest.raises(DataError):
        RecursiveML.from_bytes(archived({**arrays, "header": np.frombuffer(header, dtype=np.uint8)}))
