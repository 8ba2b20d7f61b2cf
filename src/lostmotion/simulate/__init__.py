"""Simulated signals, plants and loops."""

from lostmotion.simulate import platforms, signals
from lostmotion.simulate.adaptive_loop import AdaptiveHistory, simulate_adaptive
from lostmotion.simulate.block_loop import BlockLoop
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.loop import simulate_loop
from lostmotion.simulate.response import LoopResponse
from lostmotion.simulate.routine import routine_operation

__all__ = [
    "PI",
    "AdaptiveHistory",
    "BlockLoop",
    "LoopResponse",
    "platforms",
    "routine_operation",
    "signals",
    "simulate_adaptive",
    "simulate_loop",
]
