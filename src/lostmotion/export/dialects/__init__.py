"""The languages that blocks are exported in: one module each, one registry."""

from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.dialects.registry import TARGETS, register, restore

__all__ = ["TARGETS", "Dialect", "register", "restore"]
