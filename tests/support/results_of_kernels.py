"""Results of most kernels, as JSON: `python -m tests.support.results_of_kernels`."""

import json
import sys

import numpy as np

import lostmotion as lm


def records():
    """A record of a loop, and of a test of each sort of valve."""
    loop = lm.routine_operation(1500, drift="none", seed=3)
    yield "loop", lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1)
    generator = np.random.default_rng(1)
    u = np.cumsum(generator.normal(size=1500)) * 0.5
    for valve in (lm.Backlash(2.0), lm.Stiction(3.0, 1.0), lm.DeadZone(-1.0, 1.5)):
        x, y = valve(u), np.zeros(u.size)
        for k in range(1, y.size):
            y[k] = 0.9 * y[k - 1] + 0.1 * x[k - 1]
        yield repr(valve), lm.LoopRecord(u, y + generator.normal(scale=0.05, size=y.size), dt=1.0)


def main():
    found = {}
    for name, record in records():
        found[f"{name}, identified"] = repr(lm.identify(record))
        found[f"{name}, diagnosed"] = str(lm.diagnose(record))
        for estimator in (lm.RecursiveIV(2, 2, 1), lm.RecursiveML(2, 2, 1)):
            found[f"{name}, {type(estimator).__name__}"] = repr(
                estimator.run(record.op, record.pv).errors.tolist()[::100]
            )
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main()
