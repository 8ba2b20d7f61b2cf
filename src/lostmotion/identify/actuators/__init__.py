"""Kinds of actuator: where each is sought, how fits of several compare, what acts beside them."""

# the order of registration is the order of reports
from lostmotion.identify.actuators import no_fault, dead_zone, backlash, stiction, saturation  # noqa: F401, I001
