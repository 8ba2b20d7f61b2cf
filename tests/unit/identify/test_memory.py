"""Memory of long records: what benchmarks/speed.py measures whole, here as what NumPy allocates."""

import gc
import tracemalloc

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop

MOST = 40.0  # doubles a sample
TANK = lm.platforms.level_tank()


def identified(n, **options):
    u = lm.signals.prs(n, -5, 5, hold=10, seed=1)
    y = TANK.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=n)
    return lambda: lm.identify(u, y, 0.1, **options, nonlinearity="dead zone")


def diagnosed(n):
    loop = random_faulty_loop(50_004, n)
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    return lambda: lm.diagnose(record)


def doubles_per_sample(make, n):
    """Largest of all allocations of one call."""
    make(1500)()  # what is compiled stays
    work = make(n)
    gc.collect()
    tracemalloc.start()
    before, _ = tracemalloc.get_traced_memory()
    work()
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return (peak - before) / 8 / n


@pytest.mark.statistics
@pytest.mark.parametrize("options", [{"orders": (3, 2, 3), "noise": "white"}, {}], ids=["white", "auto"])
def test_identify(options):
    assert doubles_per_sample(lambda n: identified(n, **options), 50_000) < MOST


@pytest.mark.statistics
def test_diagnose():
    assert doubles_per_sample(diagnosed, 50_000) < MOST
