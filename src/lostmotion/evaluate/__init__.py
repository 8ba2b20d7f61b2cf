"""How good: bounds, indices, and estimators measured on random loops."""

from lostmotion.diagnose.movement import reversals, travel
from lostmotion.evaluate.cramer_rao import cramer_rao
from lostmotion.evaluate.indices import control_variance, mean_absolute_error
from lostmotion.evaluate.monte_carlo import MonteCarloResult, monte_carlo
from lostmotion.evaluate.random_faults import FaultyLoop, random_faulty_loop
from lostmotion.evaluate.random_loops import RandomLoop, random_loop
from lostmotion.evaluate.solution import Solution, Step
from lostmotion.evaluate.solve import solve
from lostmotion.evaluate.study import CompensationStudy, compensation_study
from lostmotion.evaluate.tuning import simc

__all__ = [
    "CompensationStudy",
    "FaultyLoop",
    "MonteCarloResult",
    "RandomLoop",
    "Solution",
    "Step",
    "compensation_study",
    "control_variance",
    "cramer_rao",
    "mean_absolute_error",
    "monte_carlo",
    "random_faulty_loop",
    "random_loop",
    "reversals",
    "simc",
    "solve",
    "travel",
]
