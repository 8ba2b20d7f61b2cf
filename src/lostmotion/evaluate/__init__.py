"""How good: bounds, indices, and estimators measured on random loops."""

from lostmotion.evaluate.audit_class import AuditClass, audit_class
from lostmotion.evaluate.cramer_rao import cramer_rao
from lostmotion.evaluate.harris import HarrisIndex, harris_index
from lostmotion.evaluate.indices import control_variance, mean_absolute_error, reversals, travel
from lostmotion.evaluate.monte_carlo import MonteCarloResult, monte_carlo
from lostmotion.evaluate.movement import reversals_per_hour, share_at_limits, travel_per_hour
from lostmotion.evaluate.random_loops import RandomLoop, random_loop

__all__ = [
    "AuditClass",
    "HarrisIndex",
    "MonteCarloResult",
    "RandomLoop",
    "audit_class",
    "control_variance",
    "cramer_rao",
    "harris_index",
    "mean_absolute_error",
    "monte_carlo",
    "random_loop",
    "reversals",
    "reversals_per_hour",
    "share_at_limits",
    "travel",
    "travel_per_hour",
]
