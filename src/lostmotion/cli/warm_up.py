"""``lostmotion warm-up``."""

from __future__ import annotations

import numpy as np

import lostmotion as lm
from lostmotion.cli.closed_output import echo
from lostmotion.cli.progress import progress


def warm_up() -> None:
    """Compile everything for this processor now, once, so that no later command waits for it.

    Example: lostmotion warm-up

    What is compiled is kept in the cache folder of the user (NUMBA_CACHE_DIR, where that is set). Without this command
    the first identify and the first diagnose compile what they need.
    """
    from lostmotion.kernels.numba_cache import FOLDER

    _run_everything()
    progress("")
    echo(f"Compiled, in {FOLDER}")


def _run_everything() -> None:
    """Small examples of all that needs kernels."""
    from lostmotion.kernels.stamps import count_samples
    from lostmotion.kernels.stiction import sensitivities_on_ramp

    loop = lm.routine_operation(600, seed=0)
    lm.identify(loop.command, loop.measured, 0.1, nonlinearity="dead zone")
    for kind in ("backlash", "stiction", "saturation", "auto"):
        lm.identify(loop.command, loop.measured, 0.1, nonlinearity=kind)
    for valve in (lm.Backlash(0.5), lm.Stiction(0.5, 0.3), lm.Saturation(-1.0, 1.0)):
        lm.simulate_loop(lm.Hammerstein(valve, lm.LinearModel((-0.8,), (0.2,), 1, 0.1)), lm.PI(0.5, 0.5), np.ones(50))
        valve(loop.command)
    rows = loop.command.size
    sensitivities_on_ramp(loop.command, 0.5, 0.3, 0.0, 0.0, np.empty(rows), np.empty((2, rows)))
    faults: dict[str, lm.DeadZone | lm.Backlash | lm.Stiction] = {
        "dead zone": lm.DeadZone(-1.0, 1.0),
        "backlash": lm.Backlash(1.0),
        "knocker": lm.Stiction(1.0, 0.5),
        "two moves": lm.Stiction(1.0, 0.5),
    }
    for name, fault in faults.items():
        method = name if name == "two moves" else "knocker"
        block = lm.block_from_model(fault, 0.1, span=(-50.0, 50.0), method=method)
        block.step(1.0)
        block.run(np.ones(3), dtype=np.float32)
        linear = lm.LinearModel((-0.8,), (0.2,), 1, 0.1)
        lm.simulate_loop(lm.Hammerstein(fault, linear), lm.PI(0.5, 0.5), np.ones(50), compensator=block)
    recursive = lm.RecursiveML(1, 0, 1, forgetting=0.999, start_samples=200)
    recursive.run(loop.command, loop.measured)
    lm.RecursiveIV(1, 0, 1, gain=1.0).run(loop.command, loop.measured)
    record = lm.LoopRecord(loop.command, loop.measured, loop.reference, dt=0.1)
    lm.diagnose(record)
    lm.design(
        lm.platforms.level_tank(), lm.NoiseModel((), 0.03), op_limits=(-5.0, 5.0), shortest_hold=1.0, duration=60.0
    )
    count_samples(np.arange(3.0), 1.0, 0.0, np.array([np.nan, 0.0, 0.0, 0.0]), np.empty(3))
