"""The loops of the virtual commissioning: ST machine, C and kernel give the same commands, switches and all."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from tests.plc.machine import c_compiler, need

pytestmark = pytest.mark.long

PLACE = Path(__file__).resolve().parents[2] / "examples" / "plc.py"
SPEC = importlib.util.spec_from_file_location("example_plc", PLACE)
plc = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(plc)
BLOCK = lm.block_from_model(lm.DeadZone(49, 51, 3, 3), 0.1, op_noise=0.09, process_time=1.5)
CONTROLLER = lm.PI(0.5, 0.7, 0.0, 100.0)


def scans(kind, n=400):
    """Outputs over set-point moves, switches, manual, bad PV and a controller at its limits."""
    random = np.random.default_rng(0)
    level = 50.0 + random.normal(scale=4.0, size=n).cumsum()
    loop = kind(BLOCK, CONTROLLER, 50.0)
    rows, hand = [], 50.0
    for k in range(n):
        raw, manual = round(min(max(level[k], 0.0), 100.0) * plc.COUNTS), k // 40 % 5 == 4
        rows.append(loop.scan(50.0 + k // 60 % 3, raw, k // 50 % 2 == 1, k // 30 % 7 != 6, manual, hand))
        hand = rows[-1][1] if not manual else hand
    return np.array(rows)


@pytest.mark.parametrize("kind", ["InC", "InStMachine"])
def test_executed_code_gives_the_commands_of_the_kernel(kind):
    if kind == "InC":
        c_compiler()
    if kind == "InStMachine":
        need(plc.MACHINE)
    expected = scans(plc.InKernel)
    assert set(expected[:, plc.OUTPUTS.index("state")]) >= {1.0, 2.0, 3.0, 4.0}
    np.testing.assert_array_equal(scans(getattr(plc, kind)), expected)


@pytest.mark.statistics
def test_return_from_manual_is_without_a_bump():
    loop = plc.InKernel(BLOCK, CONTROLLER, 50.0)
    before = [loop.scan(50.0, round(50.0 * plc.COUNTS), True, True, False, 50.0) for _ in range(50)][-1]
    held = [loop.scan(50.0, round(49.0 * plc.COUNTS), True, True, True, before[1]) for _ in range(50)][-1]
    after = loop.scan(50.0, round(49.0 * plc.COUNTS), True, True, False, before[1])
    assert held[1] == before[1]
    assert abs(after[1] - held[1]) <= CONTROLLER.ki * 0.1 * 1.0 + BLOCK.settings["ramp_step"]
