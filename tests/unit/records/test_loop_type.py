"""What the type of a loop says about its process reaches the identification."""

from __future__ import annotations

from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop
from lostmotion.identify.estimate import FLOW
from lostmotion.records import prepare


@pytest.fixture(scope="module")
def drifting() -> lm.LoopRecord:
    """A sound flow loop whose drift looks as if the process integrated."""
    loop = random_faulty_loop(50_002, 2000)
    return lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))


@pytest.mark.statistics
def test_a_flow_is_no_level(drifting: lm.LoopRecord) -> None:
    flow = replace(drifting, loop_type="flow")
    assert lm.identify(drifting, nonlinearity="none").chosen.integrating
    for record in (flow, prepare(flow), [flow, flow]):
        fit = lm.identify(record, nonlinearity="none")
        assert not fit.chosen.integrating
        assert FLOW in fit.data.notes


@pytest.mark.statistics
def test_what_is_said_outright_comes_first(drifting: lm.LoopRecord) -> None:
    fit = lm.identify(replace(drifting, loop_type="flow"), nonlinearity="none", integrating=True)
    assert fit.chosen.integrating
    assert FLOW not in fit.data.notes


@pytest.mark.statistics
def test_records_of_two_types_say_nothing(drifting: lm.LoopRecord) -> None:
    both = [replace(drifting, loop_type=kind) for kind in ("flow", "level")]
    assert lm.identify(both, nonlinearity="none").chosen.integrating


@pytest.mark.statistics
def test_the_type_that_is_asked_for_is_that_of_the_diagnosis(drifting: lm.LoopRecord) -> None:
    tagged = replace(drifting, loop_type="flow")
    found = lm.diagnose(tagged)
    assert not found.fit.chosen.integrating
    assert FLOW in found.notes
    assert lm.diagnose(tagged, loop_type="pressure").fit.chosen.integrating
    assert not lm.diagnose(drifting, integrating=False).fit.chosen.integrating
