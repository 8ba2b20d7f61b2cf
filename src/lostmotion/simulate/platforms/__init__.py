"""Simulated plants."""

from lostmotion.simulate.platforms.level_tank import level_tank

__all__ = ["level_tank"]
