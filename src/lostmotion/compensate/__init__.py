"""Inverses of actuator faults, as blocks that run sample by sample."""

from lostmotion.compensate.adaptive import AdaptiveCompensator, Supervisor
from lostmotion.compensate.backlash_inverse import BacklashCompensator
from lostmotion.compensate.block import BlockResponse, CompensatorBlock
from lostmotion.compensate.dead_zone_inverse import DeadZoneCompensator
from lostmotion.compensate.derive import block_from_fit, block_from_model, compensator_from_fit
from lostmotion.compensate.saved_block import read_block, read_fit_or_block
from lostmotion.compensate.specification import SPECIFICATIONS, Specification
from lostmotion.compensate.variables import Variable

__all__ = [
    "SPECIFICATIONS",
    "AdaptiveCompensator",
    "BacklashCompensator",
    "BlockResponse",
    "CompensatorBlock",
    "DeadZoneCompensator",
    "Specification",
    "Supervisor",
    "Variable",
    "block_from_fit",
    "block_from_model",
    "compensator_from_fit",
    "read_block",
    "read_fit_or_block",
]
