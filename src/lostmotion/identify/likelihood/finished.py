"""From a rough fit to a finished one: on all rows, with the noise order and the zero that its residual asks for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.coloured import with_coloured_noise
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.noise_order import choose_noise
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine
from lostmotion.identify.scaled import ScaledData


def finished(data: ScaledData, best: Fitted, asked: Asked) -> Fitted:
    """Converged, with the noise order that its residual asks for."""
    d = best.parts.d
    if asked.noise is None:
        d = choose_noise(best.output_residual())
    s = best.problem.structure
    whole = best.problem.segments is data.segments and s.start == s.delay + s.noise_order
    if not (best.fit.converged and whole and d.size == s.noise_order):
        best = refined(data, best, d)
    return with_coloured_noise(best, asked)


def refined(data: ScaledData, best: Fitted, d: FloatArray) -> Fitted:
    """Converged fit with noise start d, on all rows that its structure allows."""
    s, parts = best.problem.structure, best.parts
    structure = Structure(s.na, s.nb, s.delay, d.size, s.delay + d.size, s.integrating)
    problem = Problem(data.u, data.y, data.segments, best.problem.family, structure, best.problem.held)
    start = problem.pack(parts.a, parts.b, parts.eta, d, parts.offset)
    return Fitted(problem, refine(problem, start), problem.basis)


def without_load(best: Fitted) -> Fitted:
    """The same fit of an integrating process without a load, where the load explains nothing."""
    family = best.problem.family
    if not family.load:
        return best
    plain = replace(best.problem, family=family.with_load(False))
    at = best.problem.eta_at + len(family.own)
    start = np.delete(best.fit.theta, at)
    fitted = Fitted(plain, refine(plain, start), plain.basis)
    return fitted if criterion(fitted) <= criterion(best) else best
