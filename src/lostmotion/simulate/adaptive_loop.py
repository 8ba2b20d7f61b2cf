"""A closed loop with an adaptive block and a valve that changes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.brief import Brief, counted
from lostmotion.compensate import AdaptiveCompensator
from lostmotion.models import Hammerstein, Nonlinearity
from lostmotion.simulate.block_loop import BlockLoop
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.response import LoopResponse


@dataclass(frozen=True, eq=False, repr=False)
class AdaptiveHistory(Brief):
    """What the adaptive block was set to, one row a look; `samples` is when.

    Attributes
    ----------
    samples : ndarray of int, shape (m,)
    left, right : ndarray, shape (m,)
        Break points in the block.
    compensating : ndarray of bool, shape (m,)
    """

    samples: IntArray
    left: FloatArray
    right: FloatArray
    compensating: npt.NDArray[np.bool_]

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (counted(self.samples.size, "look"),)


def simulate_adaptive(
    plant: Hammerstein,
    controller: PI,
    reference: npt.ArrayLike,
    adaptive: AdaptiveCompensator,
    valve_at: Callable[[int], Nonlinearity] | None = None,
    disturbance: npt.ArrayLike | None = None,
    noise: npt.ArrayLike | None = None,
) -> tuple[LoopResponse, AdaptiveHistory]:
    """Simulate a loop from rest whose block is looked after by `adaptive`.

    Parameters
    ----------
    plant : Hammerstein
        Process, and valve at the start.
    controller : PI
    reference : array_like, shape (n,)
        Set point.
    adaptive : AdaptiveCompensator
        It learns from the command behind the block and the measured output.
    valve_at : callable, optional
        Valve from sample k on, asked at every look; None: it stays.
    disturbance, noise : array_like, shape (n,), optional
        Added to the output; measurement noise.

    Returns
    -------
    (LoopResponse, AdaptiveHistory)
    """
    r = finite_signal("reference", reference)
    added = np.zeros(r.size) if disturbance is None else finite_signal("disturbance", disturbance, r.size)
    wiggle = np.zeros(r.size) if noise is None else finite_signal("noise", noise, r.size)
    loop = BlockLoop(plant, controller, r, added, wiggle, adaptive.running)
    rows: list[tuple[int, float, float, bool]] = []
    while loop.done < r.size:
        before = loop.done
        if valve_at is not None:
            loop.set_valve(valve_at(before))
        loop.advance(adaptive.every)
        _, command, _, measured = loop.signals[:, before:].copy()
        loop.set_block(adaptive.look(command, measured, r[before : loop.done]))
        settings = adaptive.block.settings
        rows.append((loop.done, settings["left_break"], settings["right_break"], adaptive.compensating))
    samples, left, right, on = zip(*rows, strict=True)
    return loop.response, AdaptiveHistory(np.array(samples), np.array(left), np.array(right), np.array(on))
