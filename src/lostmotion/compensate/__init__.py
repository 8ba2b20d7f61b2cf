"""Inverses of actuator faults, as blocks that run sample by sample."""

from lostmotion.compensate.dead_zone import DeadZoneCompensator

__all__ = ["DeadZoneCompensator"]
