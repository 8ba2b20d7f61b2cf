"""The first objection decides, and what rounding makes of OP is nobody's move."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.excitation import moved_freely
from lostmotion.diagnose.features import CARRIES, SILENT, Features, Measured
from lostmotion.diagnose.objections import OBJECTIONS, SWINGS, Case, _by_its_wave, objection, sticks
from lostmotion.identify.actuators.kind import kind_of
from lostmotion.identify.data import collect
from tests.support.diagnoses import example


def case(verdict: str, features: Features = Features(), sticking: float = 1.0, level: bool = True) -> Case:  # noqa: B008
    measured = Measured(features, SILENT, SILENT, 40.0, level, {})
    return Case(verdict, example().fit, measured, True, sticking, level, False)


def test_what_speaks_for_itself_meets_none() -> None:
    fit = example().fit
    assert objection(case(fit.kind.name, Features(memory=3.0, dead_zone=3.0))) is None


def test_what_is_undecided_says_why() -> None:
    found = objection(case("cannot tell", Features(memory=3.0)))
    assert found is not None
    assert "weigh about the same" in found.why
    for status, words in (
        (lm.Status.SAME_SIGNAL, "proportional controller"),
        (lm.Status.CANNOT_TELL, "hardly moves PV"),
    ):
        one = case("cannot tell")
        found = objection(replace(one, fit=replace(one.fit, status=status)))
        assert found is not None
        assert words in found.why


def test_no_fault_is_named_where_op_is_pv_times_a_number() -> None:
    one = case(example().fit.kind.name, Features(memory=3.0, dead_zone=3.0))
    found = objection(replace(one, fit=replace(one.fit, status=lm.Status.SAME_SIGNAL)))
    assert found is not None
    assert "proportional controller" in found.why


def test_a_wave_alone_in_a_flow_is_met_with_its_limit() -> None:
    found = objection(case("stiction", level=False))
    assert found is not None
    assert "no valve that sticks foretells PV better" in found.why
    assert found.limit == pytest.approx(CARRIES * float(np.ptp(example().fit.data.u)))


@pytest.mark.parametrize(
    ("name", "said"), [("none", "a valve without lost motion fits best"), ("dead zone", "a dead zone fits best")]
)
def test_what_fits_best_where_no_fault_does_is_no_none(name: str, said: str) -> None:
    fit = SimpleNamespace(kind=kind_of(name), status=lm.Status.OK, kinds=None, parameters={}, data=example().fit.data,
                          model=example().fit.model, evidence=example().fit.evidence)  # fmt: skip
    found = _by_its_wave(replace(case("stiction", sticking=-1.0), fit=fit))  # type: ignore[arg-type]
    assert found == f"{said}, which makes no such wave, and no valve that sticks foretells PV better"


def test_a_swing_from_outside_names_no_level() -> None:
    one = case(SWINGS)
    assert all(not look(one) for _, look in OBJECTIONS[4:6])


def test_kinds_that_stick() -> None:
    assert [sticks(name) for name in ("backlash", "stiction", "dead zone", "saturation", "none", SWINGS)] == [
        True, True, False, False, False, False,
    ]  # fmt: skip


def test_rounding_of_op_is_no_free_move() -> None:
    rng = np.random.default_rng(0)
    op, pv = rng.normal(size=3000).cumsum() * 0.3, rng.normal(size=3000)
    data = collect(op, pv, 1.0)
    rounded = replace(data, u=np.round(op, 1))
    share = 2.0 * 0.01 / 12.0 / float(np.var(np.diff(rounded.u)))
    assert moved_freely(data, 0.02) == 0.02
    assert moved_freely(rounded, 0.02) == pytest.approx(0.02 - share, rel=1e-6)
    assert moved_freely(rounded, 0.5 * share) == 0.0
