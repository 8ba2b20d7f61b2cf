"""Simulated signals, plants and loops."""

from lostmotion.simulate import platforms, signals
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.loop import LoopResponse, simulate_loop
from lostmotion.simulate.routine import routine_operation

__all__ = ["PI", "LoopResponse", "platforms", "routine_operation", "signals", "simulate_loop"]
