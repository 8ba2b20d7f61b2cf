"""A valve with a memory gets no block against a dead zone: small part of ``benchmarks/wrong_inverse.py``."""

import numpy as np
import pytest
from benchmarks.verdicts.physical_valve import Gap, Stem, physical_loop

import lostmotion as lm
from lostmotion.errors import GateError
from lostmotion.identify.evidence import crossings


def test_crossings_count_noise_about_the_end_once_and_no_step_between_segments():
    op = np.array([-2.0, 1.1, 0.9, 1.1, -2.0, 0.3, -1.2, 1.2])
    assert crossings(op, np.array([[0, 8]]), -1.0, 1.0) == 3
    assert crossings(op, np.array([[0, 4], [4, 8]]), -1.0, 1.0) == 2
    assert crossings(np.full(3, -2.0), np.array([[0, 3]]), -1.0, 1.0) == 0


def test_the_valves_of_the_benchmark_do_what_they_are_called():
    gap = Gap(2.0)
    assert [gap.move(command) for command in (50.5, 52.0, 51.0, 49.0)] == [50.0, 51.0, 51.0, 50.0]
    stem = Stem(np.random.default_rng(0), 4.0, 2.0, 0.02)
    assert {stem.move(52.9) for _ in range(50)} == {50.0}
    assert 50.0 + 1.5 < [stem.move(53.1) for _ in range(500)][-1] < 53.1


@pytest.mark.statistics
@pytest.mark.parametrize(("seed", "kind"), [(61037, "stiction"), (61002, "backlash")])
def test_no_block_against_a_dead_zone_in_a_valve_that_has_none(seed, kind):
    loop = physical_loop(seed, kind)
    fit = lm.identify(lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0)))
    if fit.kind.name == "dead zone":
        assert fit.status is lm.Status.FEW_CROSSINGS
        assert not fit.status.ok
        with pytest.raises(GateError):
            fit.block()
    else:
        assert fit.block().kind == kind
