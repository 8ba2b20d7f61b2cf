"""How good: bounds and indices."""

from lostmotion.evaluate.cramer_rao import cramer_rao

__all__ = ["cramer_rao"]
