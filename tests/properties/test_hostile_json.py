"""Fits and blocks with one value changed: each is refused in one line or can be used, whatever stands in it."""

import json
import warnings

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import DataError, FileAccessError, InputError
from lostmotion.files import read_json
from tests.support.exports import block
from tests.support.hostile_values import mutants
from tests.support.use_of_json import outcome, use


@pytest.fixture(autouse=True)
def _strict():
    """Warnings are errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.fixture(scope="module")
def fit():
    u = lm.signals.prs(600, -5, 5, hold=8, seed=1)
    noise = 0.02 * np.random.default_rng(3).standard_normal(u.size)
    y = lm.Hammerstein(lm.DeadZone(-1.0, 1.0), lm.LinearModel((-0.8,), (0.2,), 1)).simulate(u) + noise
    return lm.identify(u, y, dt=1.0, nonlinearity="dead zone", orders=(1, 0, 1), noise="white").to_dict()


def faults(data, share, path):
    found = []
    for made in [data, *mutants(data, np.random.default_rng(2), share)]:
        path.write_text(json.dumps(made), encoding="utf-8")
        said = outcome(path)
        if said.startswith("TRACEBACK") or "MANY" in said:
            found.append(said)
    return found


def test_a_sample_of_changed_blocks(tmp_path):
    assert use_works(block("backlash").to_dict(), tmp_path)
    assert faults(block("backlash").to_dict() | {"accepted": "because"}, 0.15, tmp_path / "a.json") == []


def test_a_sample_of_changed_fits(fit, tmp_path):
    assert use_works(fit, tmp_path)
    assert faults(fit, 0.02, tmp_path / "a.json") == []


def use_works(data, folder):
    (folder / "whole.json").write_text(json.dumps(data))
    return use(folder / "whole.json").to_dict()


BAD = (
    "[" * 100_000, '{"model":' * 100_000, "1" * 5000, '{"kind":' + "1" * 5000 + "}", "", "\0", "[]",
    '{"model": NaN}', '{"kind": "backlash", "scan_time": 1e999, "settings": {}}',
    '{"model": ' + "[" * 60 + "]" * 60 + "}",
)  # fmt: skip


@pytest.mark.parametrize("text", BAD, ids=range(len(BAD)))
def test_json_that_is_none_of_ours(text, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(text)
    with pytest.raises(DataError):
        use(path)


def test_what_is_no_file_is_not_read(tmp_path):
    for path in ("/dev/zero", tmp_path):
        with pytest.raises(FileAccessError):
            read_json(path, "a fit", "..")


@pytest.mark.parametrize("process", [{"b": [0.0]}, {"b": [0.0, 0.0]}, {"a": [1e308]}, {"b": [-1e150]}, {"dt": 5e-324}])
def test_a_process_that_cannot_be_is_refused(fit, process, tmp_path):
    path = tmp_path / "a.json"
    linear = fit["model"]["linear"] | process
    path.write_text(json.dumps(fit | {"model": fit["model"] | {"linear": linear}}))
    with pytest.raises(DataError):
        use(path)


def test_a_fit_without_a_width_is_refused(fit, tmp_path):
    path = tmp_path / "a.json"
    path.write_text(json.dumps(fit | {"parameters": fit["parameters"] | {"width": 0.0}}))
    with pytest.raises(InputError):
        use(path)
