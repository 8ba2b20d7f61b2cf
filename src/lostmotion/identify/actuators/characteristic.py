"""A characteristic that bends behind the lost motion: the gain of valve and process changes over the range of OP.

An equal-percentage valve has twice the gain at 70 % that it has at 50 %. A linear process behind the valve leaves that
over, and a dead zone on one side of OP is then the best of the kinds that bend. The characteristic is the straight line
and a cubic of the *position of the valve*, behind its lost motion; it is tried of every kind, the sound valve too, so
that a fault must beat a sound valve that bends as it likes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.loads import explained_by, loaded, places_of_loads
from lostmotion.identify.actuators.slopes import equal_slopes
from lostmotion.identify.likelihood.courses import Bend, Loads
from lostmotion.identify.likelihood.criterion import criterion
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.refinement import refine

PROMISING = 5.0  # of log-likelihood with all else held: then it is tried
WORTH = 20.0  # of it with everything refined: less is what a process that is not quite linear leaves over anyway
LEAST_SLOPE = 0.01  # of the mean one: a valve that closes where OP rises is none
OUTER = 0.01  # of the rows, at either end of the range, in which a cubic is not held to that
TURNED = 0.2  # of its range, by which the slope may turn back
DIFFER = 2.0  # of BIC by which two slopes are ahead of equal ones, before a curve is tried in their place
TURNS = 2  # of position and characteristic by turns


def bent(fitted: Fitted) -> Fitted:
    """The same model with a characteristic that bends, where that pays; one that has one, along the valve as it is now.

    A first look at what the errors of the straight one leave is cheap.
    """
    loads = fitted.problem.family.loads
    if loads is not None and loads.bend is not None:
        return _along(fitted)
    added = _bend(fitted)
    sizes, gain = explained_by(fitted, added.shapes)
    found = fitted
    if gain > PROMISING:
        trial = loaded(fitted, fitted.problem.y, added, sizes)
        found = _along(trial) if criterion(trial) < criterion(fitted) - 2.0 * WORTH and _is_one(trial) else fitted
    return min((found, *_in_place_of_slopes(fitted)), key=criterion)


def _in_place_of_slopes(fitted: Fitted) -> Iterator[Fitted]:
    """A curve with equal slopes, where a dead zone has two: both say that the gain differs over the range."""
    equal = equal_slopes(fitted)
    if equal is None or criterion(equal) < criterion(fitted) + 2.0 * DIFFER:
        return
    for names in (("square",), ("square", "cube")):
        added = _bend(equal, *names)
        trial = loaded(equal, equal.problem.y, added, explained_by(equal, added.shapes)[0])
        if _is_one(trial):
            yield _along(trial)


def _bend(fitted: Fitted, *names: str) -> Loads:
    bend = Bend(_position(fitted), fitted.problem.family.relative)
    return Loads((replace(bend, names=names) if names else bend,), fitted.problem.u.size)


def slopes(fitted: Fitted) -> tuple[float, float] | None:
    """Of the characteristic at the lowest and the highest position, over the mean one; None where it is straight."""
    loads = fitted.problem.family.loads
    if loads is None or loads.bend is None:
        return None
    found = _slopes(fitted, loads)
    return float(found[0]), float(found[-1])


def _slopes(fitted: Fitted, loads: Loads) -> FloatArray:
    """From the lowest to the highest position."""
    assert loads.bend is not None  # noqa: S101  asked only of those
    event = loads.events[loads.bend]
    assert isinstance(event, Bend)  # noqa: S101
    low, high = np.quantile(event.position, (OUTER, 1.0 - OUTER)).tolist()
    return event.slopes(fitted.fit.theta[places_of_loads(fitted.problem)[loads.bend]], np.linspace(low, high, 50))


def _is_one(fitted: Fitted) -> bool:
    """Whether it is the characteristic of a valve: it rises, and its slope grows or falls from one end to the other.

    One that is flat or steep in the middle stands for a dead zone or a saturation; a model that has one has its slopes,
    too, which take a part of the bend.
    """
    family = fitted.problem.family
    loads = family.loads
    if loads is None or loads.bend is None:
        return True
    found = _slopes(fitted, loads)
    low, high = sorted((found[0], found[-1]))
    beyond = max(low - found.min(), found.max() - high)
    return bool(found.min() > LEAST_SLOPE and (family.places or beyond <= TURNED * np.ptp(found)))


def _along(fitted: Fitted) -> Fitted:
    """With the characteristic along the valve where it now is: it was fitted along another place of it."""
    if not fitted.problem.family.own:
        return fitted
    for _ in range(TURNS):
        problem, loads = fitted.problem, fitted.problem.family.loads
        assert loads is not None  # noqa: S101
        problem = replace(problem, family=problem.family.with_loads(loads.along(_position(fitted))))
        trial = replace(fitted, problem=problem, fit=refine(problem, fitted.fit.theta, fitted.basis))
        if criterion(trial) >= criterion(fitted) - 1.0 or not _is_one(trial):
            break
        fitted = trial
    return fitted


def _position(fitted: Fitted) -> FloatArray:
    """Of the valve, (n,), in units of scaled OP."""
    problem, x = fitted.problem, np.empty(fitted.problem.u.size)
    problem.family.path(fitted.fit.theta[problem.own.start : problem.own.stop], problem.u, x)
    return x
