"""Simulated output of a fit, from a beginning that the record supports."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import with_states
from lostmotion.models.noise import white_share


def simulated_output(fitted: Fitted) -> list[FloatArray]:
    """Simulated output from row `first` of each segment.

    The likelihood is conditional on the first rows of a segment. Where the process is faster than the memory of the
    noise its initial states have died out when the others begin: whatever fits one of these is taken, and the beginning
    runs off (in 29 of 136 real records, once 420 times as far as the rest). Here the first rows count as well, with the
    noise before them taken as zero and the weight of a stationary noise.
    """
    problem, theta = fitted.problem, fitted.fit.theta
    if problem.early == 0.0 and problem.structure.noise_order and problem.size > problem.initial_at:
        problem = replace(problem, early=white_share(fitted.parts.d))
        theta = with_states(problem, theta)
    return problem.predict(theta)[0]
