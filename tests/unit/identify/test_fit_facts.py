"""A known fit: its file, what is refused, and that all who use it take it from anywhere."""

import copy
import json
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.cli.origin import saved_block
from lostmotion.compensate import read_fit_or_block
from lostmotion.compensate.saved_block import read_origin
from lostmotion.design.prior import known as known_before_test
from lostmotion.errors import DataError, FileAccessError, ParameterError
from lostmotion.evaluate.study.faults import fault_of
from lostmotion.evaluate.study.studied_loop import known
from lostmotion.export import export
from lostmotion.identify import facts_of
from tests.support.fits import VALVES, made_fit
from tests.support.refusals import refusal


@pytest.fixture(scope="module")
def fit():
    return made_fit("dead zone")


@pytest.fixture(scope="module")
def saved(fit, tmp_path_factory):
    return fit.save(tmp_path_factory.mktemp("fit") / "fit.json")


def test_noise_of_op_is_in_the_file(fit, saved):
    facts = lm.read_fit(saved)
    assert facts.op_noise == fit.data.u_noise > 0.0
    assert facts.block().settings == fit.block().settings
    assert any("noise of OP" in note for note in facts.block().notes)


def test_older_file_has_no_noise_of_op_and_no_profiles(fit):
    for kind in VALVES:
        newer = made_fit(kind)
        data = json.loads(json.dumps(newer.to_dict()))
        del data["data"]["op_noise"], data["profiled"]
        facts = lm.FitFacts.from_dict(data)
        assert facts.op_noise is None
        for name in newer.parameters:
            assert facts.interval(name, 0.8) == pytest.approx(newer.interval(name, 0.8), rel=1e-12, nan_ok=True)
        if kind in ("dead zone", "backlash"):
            assert any("not given" in note for note in facts.block().notes)
    assert "noise of OP not known" in facts.summary()


def test_frozen_and_apart_from_the_fit(fit):
    facts = fit.facts
    with pytest.raises(FrozenInstanceError):
        facts.dt = 1.0
    with pytest.raises(ValueError, match="read-only"):
        facts.covariance[0, 0] = 0.0
    facts.parameters["left"] = 0.0
    assert fit.parameters["left"] == VALVES["dead zone"].left
    assert facts.facts is facts
    assert str(facts).startswith("FIC-101: dead zone of width")
    assert facts.compensator()(60.0) == fit.compensator()(60.0)


def test_save_does_not_replace(fit, saved):
    with pytest.raises(FileAccessError):
        fit.save(saved)
    assert fit.save(saved, force=True) == saved


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "null", "{}", '{"status": "OK"}', "[" * 100_000, '{"kind": "backlash"}', "\udce4"]
)
@pytest.mark.parametrize("read", [lm.read_fit, lm.read_block, read_fit_or_block])
def test_damaged_files_are_refused(tmp_path, text, read):
    path = tmp_path / "a.json"
    path.write_bytes(text.encode("utf-8", "surrogateescape"))
    refusal(DataError, read, path)


@pytest.mark.parametrize("read", [lm.read_fit, lm.read_block, read_fit_or_block])
def test_absent_files_and_folders_are_refused(tmp_path, read):
    for path in (tmp_path, tmp_path / "none.json"):
        with pytest.raises(FileAccessError):
            read(path)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (("status",), "GOOD", "status of a fit"),
        (("preferred",), "backlash", "preferred 'dead zone'"),
        (("covariance",), [[1.0]], "covariance of"),
        (("noise", "d"), 0.5, "noise.d of a fit"),
        (("parameters", "left"), "48", "parameters.left"),
        (("data", "dt"), True, "data.dt"),
        (("data", "samples"), 1.5, "data.samples"),
        (("data", "op_range"), [5.0, 1.0], "data.op_range"),
        (("model", "nonlinearity", "left_slope"), -1.0, "model.nonlinearity"),
        (("model", "nonlinearity", "kind"), "series", "model.nonlinearity"),
        (("evidence", "rivals"), [[1.0, 2.0]], "evidence.rivals"),
        (("settings", "chosen"), None, "settings.chosen"),
    ],
)
def test_what_is_wrong_in_a_fit_is_named(fit, place, value, said):
    data = copy.deepcopy(fit.to_dict())
    group = data
    for name in place[:-1]:
        group = group[name]
    group[place[-1]] = value
    assert said in refusal(DataError, lm.FitFacts.from_dict, data)


def test_a_fit_is_taken_from_anywhere(fit, saved):
    forms = [fit, fit.facts, lm.read_fit(saved), fit.to_dict(), json.loads(saved.read_text())]
    assert len({json.dumps(facts_of(form).to_dict()) for form in forms}) == 1
    assert {known(form, None).source for form in forms} == {"a fit of 200 samples of FIC-101, status OK"}
    assert len({known_before_test(form, None, 0.3).model for form in forms}) == 1
    headers = {export(fit.block(), "st", name="FY", date="2026-01-31", fit=form).source.data for form in forms}
    assert headers == {f"FIC-101.csv, 200 samples of 0.5 s, fingerprint {fit.data.fingerprint}"}
    refusal(ParameterError, facts_of, 3.0)


def test_saved_blocks(fit, tmp_path):
    block, path = fit.block(), tmp_path / "block.json"
    path.write_text(json.dumps(block.to_dict()), encoding="utf-8")
    assert lm.read_block(path) == read_fit_or_block(path) == block
    assert lm.read_block(path).notes == block.notes
    assert read_origin(path) == {}
    path.write_text(json.dumps(saved_block(block, fit)), encoding="utf-8")
    assert lm.read_block(path) == block
    done = export(block, "st", name="FY", date="2026-01-31", origin=read_origin(path))
    assert done.files == export(block, "st", name="FY", date="2026-01-31", fit=fit).files
    path.write_text(json.dumps({**block.to_dict(), "origin": {"data": 3}}), encoding="utf-8")
    assert "origin.data" in refusal(DataError, read_origin, path)
    assert block.changed(0.5) is block
    assert "scan time" in refusal(ParameterError, block.changed, 7.0)
    for wrong in ({"cap": "x"}, {"cap": -1.0}, {"caps": 1.0}, {"cap": None}):
        path.write_text(json.dumps({**block.to_dict(), "settings": wrong}), encoding="utf-8")
        refusal(DataError, lm.read_block, path)


class Wobble:
    """A kind that nobody told the rules about."""

    kind = "wobble"
    own = ("size",)
    size_name = "size"

    def __call__(self, u):
        return u

    def to_dict(self):
        return {"kind": self.kind}


def test_a_kind_that_was_forgotten_is_refused_everywhere():
    assert "Wobble" in refusal(ParameterError, lm.block_from_model, Wobble(), 1.0)
    assert "wobble" in refusal(ParameterError, fault_of, Wobble())
    plant = lm.Hammerstein(Wobble(), lm.LinearModel([-0.5], [0.5], 1, 1.0))
    refusal(ParameterError, lm.compensation_study, plant, lm.PI(1.0, 0.1), noise=0.0)
    refusal(ParameterError, lm.compensation_study, lm.Hammerstein(lm.Identity(), plant.linear), lm.PI(1, 1), noise=0.0)


@pytest.mark.parametrize("kind", ["saturation", "none"])
def test_a_fit_without_a_size_is_refused_everywhere(kind):
    fit = made_fit(kind)
    assert "mend" in refusal(DataError, lm.compensation_study, fit, lm.PI(1.0, 0.1))
    refusal(ParameterError, fit.block)
    refusal(DataError, lm.design, fit, op_limits=(40, 60), duration=100.0)


def test_an_unbounded_width_stays_unbounded():
    fit = made_fit("stiction", lm.Status.NOT_SEEN, widest=np.inf)
    assert lm.FitFacts.from_dict(fit.to_dict()).interval("band") == fit.interval("band") == (0.0, np.inf)
