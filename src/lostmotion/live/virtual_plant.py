"""A plant in this process to try supervision on: a level, a flow and a temperature loop, all with worn actuators.

Each loop is a PI controller, a supervised block in a :class:`~lostmotion.live.virtual_plc.VirtualPlc`, an actuator with
backlash or a dead zone and a process, stepped scan by scan in simulated time. Whoever operates it presses
:meth:`VirtualLoop.accept`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion.compensate import CompensatorBlock, block_from_model
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.kernels import actuator
from lostmotion.kernels.loop import pi_step
from lostmotion.live.virtual_plc import VirtualPlc
from lostmotion.models import Backlash, DeadZone

LOW, HIGH = 0.0, 100.0
LOAD_SECONDS = 240.0
MIDDLE = 50.0  # OP between heating and cooling
Process = Callable[[float, float], float]  # new process value from the present one and the opening of the valve


def tank(scan_time: float, outflow: float = 45.0, seconds: float = 200.0) -> Process:
    """Level of a tank in %, drained at a fixed rate; 1 % more opening fills 1 % in `seconds`."""
    return lambda level, opening: min(max(level + scan_time * (opening - outflow) / seconds, LOW), HIGH)


def pipe(scan_time: float, gain: float = 1.2, seconds: float = 4.0) -> Process:
    """Flow in % behind a valve: a lag of the first order."""
    part = 1.0 - float(np.exp(-scan_time / seconds))
    return lambda flow, opening: flow + part * (gain * opening - flow)


def jacket(scan_time: float, gain: float = 1.2, seconds: float = 4.0) -> Process:
    """Temperature in % of a small jacket, heated above the middle of OP and cooled below it, in split range."""
    part = 1.0 - float(np.exp(-scan_time / seconds))
    return lambda heat, opening: heat + part * (MIDDLE + gain * opening - heat)


@dataclass
class VirtualLoop:
    """One loop, in % throughout.

    `kp` and `ki` are those of a parallel PI, `noise` is the deviation of the noise of PV, `load` that of a disturbance
    at the valve, which wanders within minutes. A recipe moves the set point by `swing` up and down every
    `swing_seconds`. `kind` is "backlash", or "dead zone" around the middle of OP; `commissioned` is the width that the
    block was made for, where the actuator has worn since.
    """

    name: str
    process: Process
    width: float
    kp: float
    ki: float
    sp: float
    noise: float = 0.05
    load: float = 1.0
    scan_time: float = 0.5
    seed: int = 0
    automatic: bool = True
    manual: float = 45.0
    pv: float = 50.0
    kind: str = "backlash"
    commissioned: float | None = None
    swing: float = 0.0
    swing_seconds: float = 60.0
    make_plc: Callable[[SupervisedBlock], VirtualPlc] = VirtualPlc
    plc: VirtualPlc = field(init=False)

    def __post_init__(self) -> None:
        self.block = SupervisedBlock.of(self._plain(), show_scans=2, least_scans=20, block_key=self.seed + 1)
        self.plc = self.make_plc(self.block)
        self.plc.set("enable", 1.0)
        self._random = np.random.default_rng(self.seed)
        self._integral, self._pressed, self._wander, self.time = self.manual, False, 0.0, 0.0
        self._valve = actuator.init(self.manual)
        self.wear(self.width)
        self._measured, self.op, self.command = self.pv, self.manual, self.manual

    def accept(self) -> None:
        """The operator's button: an edge in the next scan."""
        self._pressed = True

    @property
    def set_point(self) -> float:
        """Of the operator, and what the recipe adds to it now."""
        up = int(self.time / self.swing_seconds) % 2 == 1
        return self.sp + (self.swing if up else -self.swing)

    def wear(self, width: float) -> None:
        """Another width of the backlash or dead zone from now on, in units of OP."""
        self.width = width
        half, play = 0.5 * width, self.kind == "backlash"
        self._fault = actuator.BACKLASH if play else actuator.DEAD_ZONE
        self._widths = np.array([width, 0.0, 0.0, 0.0] if play else [MIDDLE - half, MIDDLE + half, 1.0, 1.0])

    def _plain(self) -> CompensatorBlock:
        """Block that was commissioned; that of a dead zone with room for a wider one, and a little less than all."""
        width = self.width if self.commissioned is None else self.commissioned
        settings: dict[str, Any] = {"op_noise": abs(self.kp) * self.noise, "process_time": 20.0}
        if self.kind == "backlash":
            return block_from_model(Backlash(width), self.scan_time, **settings)
        zone = DeadZone(MIDDLE - 0.5 * width, MIDDLE + 0.5 * width)
        return block_from_model(zone, self.scan_time, factor=0.9, cap=width, **settings)

    def scan(self) -> None:
        """One scan of controller, block, valve and process."""
        self.time += self.scan_time
        self._measured = self.pv + float(self._random.normal(scale=self.noise))
        before = self._integral
        error = self.set_point - self._measured
        op, self._integral = pi_step(error, before, self.kp, self.ki * self.scan_time, LOW, HIGH)
        self.op = op if self.automatic else self.manual
        wired = {"auto_mode": self.automatic, "cascade": True, "good": True, "accept": self._pressed}
        for name, value in wired.items():
            self.plc.set(name, float(value))
        self._pressed = False
        self.command = self.plc.scan(self.op)
        back = self.plc.read(["back"])["back"]
        if not self.automatic:
            self._integral = self.manual
        elif op > back:
            self._integral = min(self._integral, before)
        elif op < back:
            self._integral = max(self._integral, before)
        opening = actuator.step(self._fault, self._widths, self._valve, self.command)
        part = self.scan_time / LOAD_SECONDS
        self._wander += self.load * math.sqrt(2.0 * part) * float(self._random.normal()) - part * self._wander
        self.pv = self.process(self.pv, float(opening) + self._wander)

    def values(self) -> Mapping[str, float]:
        """What a historian sees: SP, PV, OP, mode."""
        return {"sp": self.set_point, "pv": self._measured, "op": self.op, "mode": float(self.automatic)}


class VirtualPlant:
    """Loops by name, stepped together."""

    def __init__(self, loops: Mapping[str, VirtualLoop]) -> None:
        self.loops = dict(loops)

    @classmethod
    def worn(cls, seed: int = 0, make_plc: Callable[[SupervisedBlock], VirtualPlc] = VirtualPlc) -> VirtualPlant:
        """Level LIC-101 and flow FIC-102 with backlash, temperature TIC-103 in split range with a dead zone.

        Parameters
        ----------
        seed : int
            Of noise and loads.
        make_plc : callable
            Gives what executes a block.
        """
        loops = (
            VirtualLoop(
                "LIC-101", tank(0.5), width=3.0, kp=4.0, ki=0.02, sp=50.0, noise=0.02, seed=seed, make_plc=make_plc
            ),
            VirtualLoop(
                "FIC-102", pipe(0.5), width=2.0, kp=0.5, ki=0.12, sp=54.0, noise=0.05, seed=seed + 1, make_plc=make_plc
            ),
            VirtualLoop(
                "TIC-103", jacket(0.5), width=4.0, kp=0.5, ki=0.12, sp=50.0, noise=0.05, load=0.1, seed=seed + 2,
                manual=MIDDLE, kind="dead zone", commissioned=2.8, swing=3.0, make_plc=make_plc,
            ),
        )  # fmt: skip
        return cls({loop.name: loop for loop in loops})

    def close(self) -> None:
        """End what executes the blocks."""
        for loop in self.loops.values():
            loop.plc.close()

    def step(self, scans: int = 1) -> None:
        """So many scans of every loop."""
        for _ in range(scans):
            for loop in self.loops.values():
                loop.scan()

    def values(self) -> dict[str, float]:
        """Every tag, e.g. ``"FIC-102.PV"``."""
        return {f"{name}.{tag.upper()}": v for name, loop in self.loops.items() for tag, v in loop.values().items()}
