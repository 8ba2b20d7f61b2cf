"""Laws of supervised blocks under random supervision, and that a block that breaks them is seen."""

import dataclasses
import os

import numpy as np
import pytest

from lostmotion.export import TARGETS
from lostmotion.export.dialects import restore
from lostmotion.export.reader import Program
from tests.support.exports import KINDS, REALS
from tests.support.supervised import source
from tests.support.supervised_laws import played, random_supervision, violations

ROWS = 1_000 if os.environ.get("NUMBA_DISABLE_JIT") else 4_000


def quiet(kind, real="lreal"):
    """A block whose offset moves by the ramp at all times, so that any larger step is one."""
    one = source(kind, real)
    block = one.block.block.with_settings(rate=one.values["ramp_step"])
    return dataclasses.replace(one, block=dataclasses.replace(one.block, block=block))


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_laws_under_random_supervision(kind, real):
    one = quiet(kind, real)
    inputs, cold = random_supervision(one, ROWS, seed=5)
    outputs = played(one, inputs, cold)
    broken = {law: count for law, count in violations(one, inputs, cold, outputs).items() if count}
    assert broken == {}
    names = [variable.name for variable in one.specification.section("output")]
    states = outputs[:, names.index("SUPERVISION")]
    assert (states == 3.0).mean() > 0.05
    assert set(states) == {0.0, 1.0, 2.0, 3.0, 4.0}


WRONG = {
    "edge THEN": ("shown >= show_scans THEN", "in force without an accept"),
    "silent >= timeout": ("FALSE", "active after the time-out"),
    "sum <> checksum": ("FALSE", "checksum wrong"),
    "NOT good": ("FALSE", "active in a bad state"),
    "shown < show_scans": ("FALSE", "accepted unseen"),
    "request_id < last_id": ("FALSE", "id used twice"),
}


@pytest.mark.statistics
@pytest.mark.parametrize("right", WRONG)
def test_a_block_that_breaks_a_law_is_seen(right):
    wrong, law = WRONG[right]
    one = quiet("backlash")
    text = restore(TARGETS["st"].files(one))
    assert right in text
    inputs, cold = random_supervision(one, 4_000, seed=5)
    cold[1:] = False
    wanted = [variable.name.lower() for variable in one.specification.section("output")]
    columns = [variable.name.lower() for variable in one.specification.section("input")]
    outputs = Program(text.replace(right, wrong)).run(one.values, columns, inputs, wanted)
    broken = violations(one, inputs, cold, np.asarray(outputs))
    assert broken[law] > 0, broken
