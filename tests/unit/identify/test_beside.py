"""Many actuators beside one fit: the same as one model after the other."""

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identify.actuators.backlash_family import BacklashFamily
from lostmotion.identify.likelihood.beside import Beside
from lostmotion.identify.likelihood.courses import Loads, Step, Swing
from lostmotion.identify.likelihood.problem import Problem, Structure
from lostmotion.identify.likelihood.refinement import refine, settled

SEGMENTS = np.array([[0, 300], [300, 520]])


def begun(structure: Structure, load: bool = False, loads: Loads | None = None) -> tuple[Problem, np.ndarray]:
    """A problem with a backlash of 0, and any parameters."""
    rng = np.random.default_rng(3)
    u = np.repeat(rng.normal(size=104), 5)
    y = np.convolve(u, [0.0, 0.4, 0.2, 0.1])[: u.size] + 0.1 * rng.normal(size=u.size)
    family = BacklashFamily(float(np.ptp(u)), SEGMENTS, load=load, loads=loads)
    problem = Problem(u, y, SEGMENTS, family, structure, early=0.4 if structure.zero else 0.0)
    theta = 0.1 * rng.normal(size=problem.size)
    theta[: structure.na] = [-1.3, 0.3] if structure.integrating else [-1.2, 0.4]
    theta[problem.eta_at] = 0.0
    return problem, theta


@pytest.mark.parametrize(
    ("structure", "load", "loads"),
    [
        (Structure(2, 1, 1, 3, 4), False, None),
        (Structure(2, 0, 2, 0, 5), False, None),
        (Structure(2, 1, 1, 2, 3, integrating=True), True, None),
        (Structure(2, 1, 1, 3, 4, zero=0.9), False, None),
        (Structure(2, 1, 1, 2, 6, integrating=True, zero=0.5), True, None),
        (Structure(2, 1, 1, 3, 4), False, Loads((Step(90, 0, 300), Swing(17.0, 300, 520)), 520)),
    ],
)
@pytest.mark.parametrize("size", [0.3, 2.0])
def test_settles_as_one_model_alone(structure: Structure, load: bool, loads: Loads | None, size: float) -> None:
    problem, theta = begun(structure, load, loads)
    held = problem.free_but(problem.own)
    beside = Beside(problem, theta, held)
    own = np.array([size])
    other = replace(problem, family=problem.family.with_rests((0.4, -0.2)))
    theta[problem.eta_at] = size
    expected = settled(other, theta, held)
    found, cost = beside.settled(other.family, own)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    assert cost == pytest.approx(other.evaluate(expected)[0], rel=1e-10)


def test_a_refinement_ends_where_its_bound_is_out_of_reach() -> None:
    problem, theta = begun(Structure(2, 1, 1, 3, 4))
    whole = refine(problem, theta)
    assert refine(problem, theta, bound=2.0 * whole.cost).cost == whole.cost
    given_up = refine(problem, theta, bound=0.5 * whole.cost)
    assert given_up.steps < whole.steps
    assert given_up.cost > 0.5 * whole.cost
