"""How good: bounds, indices, and estimators measured on random loops."""

from lostmotion.evaluate.cramer_rao import cramer_rao
from lostmotion.evaluate.indices import control_variance, mean_absolute_error, reversals, travel
from lostmotion.evaluate.monte_carlo import MonteCarloResult, monte_carlo
from lostmotion.evaluate.random_loops import RandomLoop, random_loop

__all__ = [
    "MonteCarloResult",
    "RandomLoop",
    "control_variance",
    "cramer_rao",
    "mean_absolute_error",
    "monte_carlo",
    "random_loop",
    "reversals",
    "travel",
]
