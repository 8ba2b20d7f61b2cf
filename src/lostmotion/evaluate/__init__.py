"""How good: bounds and indices."""

from lostmotion.evaluate.cramer_rao import cramer_rao
from lostmotion.evaluate.indices import control_variance, mean_absolute_error, reversals, travel

__all__ = ["control_variance", "cramer_rao", "mean_absolute_error", "reversals", "travel"]
