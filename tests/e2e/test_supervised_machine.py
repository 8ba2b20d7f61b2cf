"""Supervised blocks compiled and executed: ST machine, C and Python give the same under random supervision."""

import numpy as np
import pytest

from lostmotion.export import TARGETS
from lostmotion.export.dialects import restore
from lostmotion.export.replay import compare, expected, replay
from lostmotion.export.scenarios import scenario
from tests.plc.machine import run_in_c, run_in_machine
from tests.support.exports import KINDS, REALS
from tests.support.supervised import source

pytestmark = [pytest.mark.long, pytest.mark.statistics]
ROWS = 2_500


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_st_and_c_agree_with_the_kernel(kind, real, tmp_path):
    one = source(kind, real)
    stretches = scenario(one.specification, one.parameters, ROWS, seed=2)
    kernel = expected(one, stretches)
    st = run_in_machine(restore(TARGETS["st"].files(one)), one, stretches)
    c = run_in_c(TARGETS["c"].files(one), one, stretches, tmp_path)
    for proof in (compare(one, kernel, st), compare(one, kernel, c)):
        assert proof.agrees, proof.summary()
        assert proof.worst == 0.0
    columns = {v.name: kernel[:, k] for k, v in enumerate(one.specification.section("output"))}
    assert set(columns["SUPERVISION"]) == {0.0, 1.0, 2.0, 3.0, 4.0}
    assert (columns["SUPERVISION"] == 3.0).mean() > 0.1
    assert len(set(columns["REFUSAL"])) >= 8
    assert len(set(columns["SHED_REASON"])) >= 6
    assert np.isfinite(kernel).all()


@pytest.mark.parametrize("to", TARGETS)
def test_every_dialect_by_the_replay(to):
    one = source("dead zone", "real")
    proof = replay(TARGETS[to].files(one), one, rows=800)
    assert proof.agrees, proof.summary()
