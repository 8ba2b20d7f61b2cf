"""Simulated signals, plants and loops."""

from lostmotion.simulate import platforms, signals
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.loop import LoopResponse, simulate_loop

__all__ = ["PI", "LoopResponse", "platforms", "signals", "simulate_loop"]
