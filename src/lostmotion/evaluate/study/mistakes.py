"""Plants that could stand behind the estimate: the block stays as designed, the truth is another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from lostmotion.evaluate.study.studied_loop import Known
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.models import Hammerstein

TWO = 2.0  # standard errors
SHARE = 0.2  # a fifth: what a valve changes between two tests, whatever the interval says
ATTEMPTS = 20  # draws per plant wanted: where nearly none is a process, there are fewer plants
STABLE = 1.0 - 1e-6  # largest modulus of a drawn pole, unless the process itself has a larger one
DERIVED = ("width", "slope_ratio", "gain", "load")
GROUPS = ("2 standard errors", "20 %", "drawn")
Mistake = tuple[str, str, StudyPlant]  # group, what the estimate is, the truth


def mistakes(known: Known, draws: int, seed: int) -> list[Mistake]:
    """All plants that the block is tried on, with what the estimate would be wrong by."""
    return [
        *_of_errors(known),
        *_of_share(known.plant),
        *(("drawn", f"draw {number + 1}", plant) for number, plant in enumerate(_drawn(known, draws, seed))),
    ]


def _of_errors(known: Known) -> Iterator[Mistake]:
    """Corners of the parameters of the actuator, two standard errors either way."""
    errors = known.errors
    names = [name for name in known.plant.fault.own if errors.get(name, 0.0) > 0.0]
    if "right_slope" in names and "left_slope" in names:
        names.remove("right_slope")  # the common factor of both is gain of the loop, not shape of the valve
    for signs in np.ndindex(*(2,) * min(len(names), 2)):
        moves = {name: TWO * errors[name] * (1 - 2 * sign) for name, sign in zip(names, signs, strict=False)}
        yield from _moved(known, moves)
    for name in names[2:]:
        for sign in (1.0, -1.0):
            yield from _moved(known, {name: TWO * errors[name] * sign})


def _moved(known: Known, moves: Mapping[str, float]) -> Iterator[Mistake]:
    if not moves:
        return
    valve = known.plant.valve
    values = {name: getattr(valve, name) + move for name, move in moves.items()}
    said = ", ".join(f"{name} {'too small' if move > 0 else 'too large'}" for name, move in moves.items())
    moved = known.plant.fault.with_values(values)
    if moved is not None:
        yield GROUPS[0], said, known.plant.with_valve(moved)


def _of_share(plant: StudyPlant) -> Iterator[Mistake]:
    """The estimate is a fifth too large or too small."""
    for factor, said in ((1.0 + SHARE, "20 % too large"), (1.0 - SHARE, "20 % too small")):
        for what, valve in plant.fault.scaled(1.0 / factor):
            yield GROUPS[1], f"{what} {said}", plant.with_valve(valve)


def _drawn(known: Known, count: int, seed: int) -> list[StudyPlant]:
    """Actuator, process and offset drawn from the covariance, in pairs on either side; impossible draws again."""
    names = [
        name
        for name in known.parameters
        if name not in DERIVED and np.isfinite(known.parameters[name]) and name in known.errors
    ]
    if not names:
        return []
    rows = [list(known.parameters).index(name) for name in names]
    part = known.covariance[np.ix_(rows, rows)]
    size, vectors = np.linalg.eigh(np.where(np.isfinite(part), part, 0.0))
    root = vectors * np.sqrt(np.maximum(size, 0.0))
    values = np.array([known.parameters[name] for name in names])
    random = np.random.default_rng([seed, 1])
    found: list[StudyPlant] = []
    for _ in range(ATTEMPTS * count):
        draw = root @ random.standard_normal(len(names))
        made = (_rebuilt(known.plant, dict(zip(names, values + side, strict=True))) for side in (draw, -draw))
        found += [plant for plant in made if plant is not None]
        if len(found) >= count:
            break
    return found[:count]


def _rebuilt(plant: StudyPlant, values: Mapping[str, float]) -> StudyPlant | None:
    """Plant of drawn parameters; None where they are none."""
    linear, fault = plant.model.linear, plant.fault
    moved = fault.with_values({name: values[name] for name in fault.own if name in values})
    a = tuple(float(values.get(f"a{i + 1}", old)) for i, old in enumerate(linear.a))
    b = tuple(float(values.get(f"b{i}", old)) for i, old in enumerate(linear.b))
    process = replace(linear, a=a, b=b)
    most = max(np.abs(linear.poles).max(initial=0.0), STABLE)
    if moved is None or np.abs(process.poles).max(initial=0.0) > most or process.integrates() != linear.integrates():
        return None
    if not linear.integrates() and process.gain * linear.gain <= 0.0:
        return None
    offset = float(values.get("offset", plant.model.offset))
    return replace(plant, model=Hammerstein(moved, process, offset))
