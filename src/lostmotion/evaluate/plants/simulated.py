"""A made plant in motion: signals of all loops, block by block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.evaluate.plants.disturbances import Sources, swinging
from lostmotion.evaluate.plants.network import tables
from lostmotion.kernels import coupled_loops as kernel

if TYPE_CHECKING:
    from lostmotion.evaluate.plants.plant import MadePlant

BLOCK = 7200  # rows: 50 loops take 12 MB
SETTLED = 7200.0  # seconds before the record: it does not begin at rest
Single = npt.NDArray[np.float32]
Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class Simulated:
    """Signals in % of span, each of shape (rows, loops); single precision, as historians keep them.

    Attributes
    ----------
    op, pv, sp, position : ndarray
    mode : ndarray of int8
        As in :mod:`lostmotion.kernels.coupled_loops`.
    """

    op: Single
    pv: Single
    sp: Single
    position: Single
    mode: npt.NDArray[np.int8]

    @property
    def manual(self) -> FloatArray:
        """Share of the time that each loop is in manual."""
        return np.asarray((self.mode == kernel.MANUAL).mean(axis=0))

    def of(self, number: int) -> tuple[FloatArray, FloatArray, FloatArray, npt.NDArray[np.int8]]:
        """OP, PV, SP and mode of one loop."""
        op, pv, sp = (np.asarray(one[:, number], dtype=np.float64) for one in (self.op, self.pv, self.sp))
        return op, pv, sp, self.mode[:, number]


def simulated(plant: MadePlant, progress: Progress | None = None) -> Simulated:
    """Run a plant from rest; what comes before it has settled is thrown away.

    Parameters
    ----------
    plant : MadePlant
    progress : callable, optional
        Called with the share that is done.
    """
    before = round(SETTLED / plant.dt)
    rows, n = before + plant.rows, len(plant.loops)
    loops, wires, weights = tables(plant.loops, plant.wires, plant.dt)
    events = plant.events()
    if events.size:
        events[:, 0] += before
    state, actuators = np.empty((n, kernel.STATES)), np.empty((n, 6))
    kernel.start(loops, state, actuators)
    longest = max(int(loops[:, kernel.DELAY].max()), int(wires[:, 3].max(initial=1)))
    history, lagged = np.zeros((2, n, longest + 1)), np.zeros(len(wires))
    coming = _coming(plant, rows)
    kept = np.empty((5, rows, n), dtype=np.float32)
    for begin in range(0, rows, BLOCK):
        end = min(begin + BLOCK, rows)
        load, noise = coming(begin, end - begin)
        mine = events[(events[:, 0] >= begin) & (events[:, 0] < end)]
        record = np.empty((5, end - begin, n))
        kernel.run(
            begin, loops, wires, weights, mine, load, noise, state, actuators, history, lagged, record
        )  # fmt: skip
        kept[:, begin:end] = record
        if progress is not None:
            progress(end / rows)
    op, pv, sp, position, mode = kept[:, before:]
    return Simulated(op, pv, sp, position, mode.astype(np.int8))


def _coming(plant: MadePlant, rows: int) -> Callable[[int, int], tuple[FloatArray, FloatArray]]:
    """Loads and noises of the next rows of all loops; every loop has luck of its own."""
    sources = [
        Sources(healthy, np.random.default_rng([plant.seed, number, 6]), plant.dt, rows * plant.dt)
        for number, healthy in enumerate(plant.healthy)
    ]
    swings = [(one.loop, swinging(one, rows, plant.dt)) for one in plant.swings]

    def block(begin: int, some: int) -> tuple[FloatArray, FloatArray]:
        drawn = np.array([one.block(begin, some) for one in sources])
        load, noise = np.ascontiguousarray(drawn[:, 0].T), np.ascontiguousarray(drawn[:, 1].T)
        for loop, wave in swings:
            load[:, loop] += wave[begin : begin + some]
        for number, fault in enumerate(plant.sensors):
            if fault is not None:
                noise[:, number] = fault.on(noise[:, number], begin, rows)
        return load, noise

    return block
