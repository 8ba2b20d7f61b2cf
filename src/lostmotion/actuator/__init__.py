"""What an actuator does, from OP and its measured position: dead band, resolution, rate limit, lag, offset."""

from lostmotion.actuator.estimate import actuator_response
from lostmotion.actuator.response import ActuatorResponse, ActuatorStatus

__all__ = ["ActuatorResponse", "ActuatorStatus", "actuator_response"]
