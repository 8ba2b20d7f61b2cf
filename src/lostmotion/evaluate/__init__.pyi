from .cramer_rao import cramer_rao
from .indices import control_variance, mean_absolute_error, reversals, travel
from .monte_carlo import MonteCarloResult, monte_carlo
from .random_faults import FaultyLoop, random_faulty_loop
from .random_loops import RandomLoop, random_loop
from .solution import Solution, Step
from .solve import solve
from .study import CompensationStudy, compensation_study
from .tuning import simc

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
