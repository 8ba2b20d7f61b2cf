"""Inverses of actuator faults, as blocks that run sample by sample."""

from lostmotion import _verbs
from lostmotion.compensate.dead_zone import DeadZoneCompensator
from lostmotion.models import DeadZone

_verbs.compensator.register(DeadZone, DeadZoneCompensator.from_dead_zone)

__all__ = ["DeadZoneCompensator"]
