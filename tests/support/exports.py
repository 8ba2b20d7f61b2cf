"""Blocks for the tests of the export: every kind, with settings in which every feature is in play."""

from lostmotion.compensate import CompensatorBlock
from lostmotion.export.source import Source

COMMON = {
    "band": 0.5, "quiet": 0.25, "ramp_step": 0.25, "rate": 3.0, "factor": 0.85, "safe": 30.0, "low": 10.0, "high": 90.0,
    "count_limit": 500.0,
}  # fmt: skip
KINDS = {
    "dead zone": {"left_break": 45.0, "right_break": 55.0, "centre": 50.0, "left_slope": 1.3, "right_slope": 0.8,
                  "zone": 0.6, "cap": 8.0, "hunt_scans": 20.0, "hunt_limit": 3.0},
    "backlash": {"lead_up": 0.7, "lead_down": 0.9, "pulse": 0.4, "pulse_scans": 3.0},
    "stiction knocker": {"amplitude": 1.2},
    "stiction two moves": {"overshoot": 2.0, "stand": 0.6, "move_scans": 3.0, "release": 0.8},
}  # fmt: skip
REALS = ("lreal", "real")


def block(kind, **settings):
    return CompensatorBlock.of(kind, 0.1, {**COMMON, **KINDS[kind], **settings}, ("from a test",))


def source(kind, real="lreal", **header):
    return Source(block(kind), "FY_101", "2026-01-31", real, **header)
