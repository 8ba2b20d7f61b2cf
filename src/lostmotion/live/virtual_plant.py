"""A plant in this process to try supervision on: a level tank and a flow loop, both with worn valves.

Each loop is a PI controller, a supervised block in a :class:`~lostmotion.live.virtual_plc.VirtualPlc`, a valve with
backlash and a process, stepped scan by scan in simulated time. Whoever operates it presses :meth:`VirtualLoop.accept`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from lostmotion.compensate import block_from_model
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.kernels import actuator
from lostmotion.kernels.loop import pi_step
from lostmotion.live.virtual_plc import VirtualPlc
from lostmotion.models import Backlash

LOW, HIGH = 0.0, 100.0
LOAD_SECONDS = 240.0
Process = Callable[[float, float], float]  # new process value from the present one and the opening of the valve


def tank(scan_time: float, outflow: float = 45.0, seconds: float = 200.0) -> Process:
    """Level of a tank in %, drained at a fixed rate; 1 % more opening fills 1 % in `seconds`."""
    return lambda level, opening: min(max(level + scan_time * (opening - outflow) / seconds, LOW), HIGH)


def pipe(scan_time: float, gain: float = 1.2, seconds: float = 4.0) -> Process:
    """Flow in % behind a valve: a lag of the first order."""
    part = 1.0 - float(np.exp(-scan_time / seconds))
    return lambda flow, opening: flow + part * (gain * opening - flow)


@dataclass
class VirtualLoop:
    """One loop, in % throughout.

    `kp` and `ki` are those of a parallel PI, `noise` is the deviation of the noise of PV, `load` that of a disturbance
    at the valve, which wanders within minutes.
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
    plc: VirtualPlc = field(init=False)

    def __post_init__(self) -> None:
        plain = block_from_model(
            Backlash(self.width), self.scan_time, op_noise=abs(self.kp) * self.noise, process_time=20.0
        )
        self.block = SupervisedBlock.of(plain, show_scans=2, least_scans=20, block_key=self.seed + 1)
        self.plc = VirtualPlc(self.block)
        self.plc.set("enable", 1.0)
        self._random = np.random.default_rng(self.seed)
        self._integral, self._pressed, self._wander, self.time = self.manual, False, 0.0, 0.0
        self._valve = actuator.init(self.manual)
        self._widths = np.array([self.width, 0.0, 0.0, 0.0])
        self._measured, self.op, self.command = self.pv, self.manual, self.manual

    def accept(self) -> None:
        """The operator's button: an edge in the next scan."""
        self._pressed = True

    def wear(self, width: float) -> None:
        """Another backlash from now on, in units of OP."""
        self.width, self._widths[0] = width, width

    def scan(self) -> None:
        """One scan of controller, block, valve and process."""
        self.time += self.scan_time
        self._measured = self.pv + float(self._random.normal(scale=self.noise))
        before = self._integral
        error = self.sp - self._measured
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
        opening = actuator.step(actuator.BACKLASH, self._widths, self._valve, self.command)
        part = self.scan_time / LOAD_SECONDS
        self._wander += self.load * math.sqrt(2.0 * part) * float(self._random.normal()) - part * self._wander
        self.pv = self.process(self.pv, float(opening) + self._wander)

    def values(self) -> Mapping[str, float]:
        """What a historian sees: SP, PV, OP, mode."""
        return {"sp": self.sp, "pv": self._measured, "op": self.op, "mode": float(self.automatic)}


class VirtualPlant:
    """Loops by name, stepped together."""

    def __init__(self, loops: Mapping[str, VirtualLoop]) -> None:
        self.loops = dict(loops)

    @classmethod
    def worn(cls, seed: int = 0) -> VirtualPlant:
        """The level tank LIC-101 and the flow loop FIC-102, both with backlash."""
        loops = (
            VirtualLoop("LIC-101", tank(0.5), width=3.0, kp=4.0, ki=0.02, sp=50.0, noise=0.02, seed=seed),
            VirtualLoop("FIC-102", pipe(0.5), width=2.0, kp=0.5, ki=0.12, sp=54.0, noise=0.05, seed=seed + 1),
        )
        return cls({loop.name: loop for loop in loops})

    def step(self, scans: int = 1) -> None:
        """So many scans of every loop."""
        for _ in range(scans):
            for loop in self.loops.values():
                loop.scan()

    def values(self) -> dict[str, float]:
        """Every tag, e.g. ``"FIC-102.PV"``."""
        return {f"{name}.{tag.upper()}": v for name, loop in self.loops.items() for tag, v in loop.values().items()}
