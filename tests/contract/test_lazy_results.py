"""Every result prints and draws itself where only the module of its class is imported: laziness loses no verb."""

import pickle
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from tests.support.diagnoses import example, loop_record

PLANT = lm.Hammerstein(lm.DeadZone(48.0, 52.0), lm.LinearModel((-0.9,), (0.15,), 2, 1.0))
NOISE = lm.NoiseModel((), 0.01)


def made_test():
    return lm.design(PLANT, NOISE, op_limits=(40, 60), shortest_hold=10, duration=300)


def recursive():
    record = loop_record()
    estimator = lm.RecursiveIV(1, 0, 1, gain=1.0)
    estimator.run(record.op - 50, record.pv - 50)
    return estimator.estimate


def achievable():
    plant = replace(PLANT, linear=replace(PLANT.linear, dt=5.0))
    return lm.achievable(loop_record(), plant, NOISE)


def study():
    return lm.compensation_study(example().fit, lm.PI(0.4, 0.15), sp_step=3.0, samples=400, runs=2, draws=2)


RESULTS = {
    "fit": (lambda: example().fit, ("summary", "plot", "compensator", "block")),
    "diagnosis": (example, ("summary", "plot")),
    "estimate": (recursive, ("summary",)),
    "response": (lambda: lm.simulate_loop(PLANT, lm.PI(0.4, 0.1), np.ones(50), 1.0), ("indices", "plot")),
    "test": (made_test, ("summary", "plot")),
    "achievable": (achievable, ("summary",)),
    "study": (study, ("summary", "plot")),
    "monte carlo": (lambda: lm.evaluate.monte_carlo(cases=2, samples=500, workers=1), ("summary",)),
}


# What is not ours is imported once; each result then has a process of its own.
ALONE = """
import os, pathlib, pickle, sys
import matplotlib.pyplot, numba, scipy.signal
assert "lostmotion" not in sys.modules
failed = 0
for path, *verbs in map(str.split, sys.stdin):
    child = os.fork()
    if not child:
        result = pickle.loads(pathlib.Path(path).read_bytes())
        assert not {'lostmotion.plot', 'lostmotion.report'} & set(sys.modules)
        for verb in verbs:
            assert getattr(result, verb)() is not None, (path, verb)
        os._exit(0)
    failed += os.waitpid(child, 0)[1] != 0
sys.exit(failed)
"""


@pytest.mark.long
@pytest.mark.statistics
def test_verbs_of_a_result_alone(tmp_path):
    jobs = []
    for number, (make, verbs) in enumerate(RESULTS.values()):
        path = tmp_path / f"{number}.pickle"
        path.write_bytes(pickle.dumps(make()))  # unpickling imports the module of the class and no more
        jobs.append(" ".join([str(path), *verbs]))
    done = subprocess.run(
        [sys.executable, "-c", ALONE], input="\n".join(jobs), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.long
@pytest.mark.statistics
def test_a_fit_made_by_its_own_room_prints():
    lines = [
        "import numpy as np",
        "from lostmotion.identify import identify",
        "u = np.random.default_rng(0).normal(size=200).cumsum() % 7 - 3",
        "y = np.r_[0.0, np.sign(u[:-1]) * np.maximum(np.abs(u[:-1]) - 1, 0)]",
        "fit = identify(u, y + 0.01 * u[::-1], dt=1.0, orders=(1, 0, 1), noise='white')",
        "assert 'Dead zone' in fit.summary() and fit.plot() is not None",
    ]
    done = subprocess.run([sys.executable, "-c", "\n".join(lines)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
