"""Scans that try everything: the inputs a block meets in a plant, and those it should never meet.

Made from the specification alone, the same for the same seed. A scenario is a list of stretches, each with its own
settings; the state goes on from one to the next, but for some cold starts.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.compensate import Specification
from lostmotion.compensate.supervised import SupervisedSpecification
from lostmotion.compensate.variables import Variable
from lostmotion.export.supervised_scans import supervise_scans

ODD = (np.nan, np.inf, -np.inf, 1e30, -1e30, 1e308, -1e308, 1e-310, -0.0)
ODD_SHARE = 0.02
COLD_SHARE = 0.05
COUNTS = (0.0, 0.0, 1.0, 1.0, 2.0, 3.0, 7.0)
BAD_COUNTS = (-3.0, -1.0, 0.0, 16777216.0, 2e9)
SIZES = (5e-13, 1e-12, 1e9, 2e9)  # of settings: about their bounds, inside and outside
FACTORS = (0.0, 0.3, 0.5, 0.9, 1.0, 1.1, 2.0)
LENGTHS = (4, 16, 64)  # scans of a stretch at most: many changes of settings and modes in few scans
IN_SERVICE = {"ENABLE": 1.0, "GOOD": 1.0, "TRACK": 0.0, "AUTO_MODE": 1.0, "CASCADE": 1.0}


@dataclass(frozen=True)
class Stretch:
    """Scans with one set of settings: parameters (n_parameters,), inputs (n, n_inputs), both of the block's type.

    `cold`: the block starts anew before them.
    """

    parameters: npt.NDArray[np.floating[Any]]
    inputs: npt.NDArray[np.floating[Any]]
    cold: bool = False


@dataclass(frozen=True)
class _About:
    """Numbers about which signals move: clamps, places between them, and sizes of settings."""

    low: float
    high: float
    places: tuple[float, ...]
    sizes: tuple[float, ...]
    grid: float

    @classmethod
    def of(cls, specification: Specification, settings: FloatArray) -> _About:
        """Settings of a block, sorted into places and sizes."""
        listed = specification.section("parameter")
        named = {variable.name: float(value) for variable, value in zip(listed, settings, strict=True)}
        low, high = sorted((named["LOW"], named["HIGH"]))
        span = high - low if high > low else 1.0
        reals = [abs(named[variable.name]) for variable in listed if variable.kind == "real"]
        sizes = tuple(value for value in reals if 0.0 < value <= 0.25 * span)
        places = tuple(value for value in reals if low <= value <= high)
        grid = 2.0 ** np.round(np.log2(span / 800.0))
        return cls(low, high, places or (low,), sizes or (0.01 * span,), float(grid))


def scenario(
    specification: Specification,
    parameters: npt.NDArray[np.floating[Any]],
    rows: int,
    seed: int = 0,
    *,
    tame: bool = False,
) -> list[Stretch]:
    """Stretches of up to 64 scans, `rows` in all.

    Parameters
    ----------
    specification : Specification
    parameters : ndarray
        Settings to start from; later stretches change them, to unusable ones as well.
    rows : int
    seed : int
    tame : bool
        Only finite values and only these settings, as a test in a real PLC can repeat them.
    """
    random = np.random.default_rng(seed)
    base = np.asarray(parameters, dtype=np.float64)
    about = _About.of(specification, base)
    result: list[Stretch] = []
    settings, done = base, 0
    while done < rows:
        count = int(min(rows - done, random.integers(1, _pick(random, LENGTHS) + 1)))
        usable, used = (base, base) if tame else _settings(random, specification, base, settings, about.grid)
        settings = usable
        near = about if usable is base else _About.of(specification, usable)
        grid = about.grid if random.random() < 0.5 else 0.0
        inputs = np.column_stack(
            [_column(random, count, variable, near, grid, tame) for variable in specification.section("input")]
        )
        cold = not result or (not tame and random.random() < COLD_SHARE)
        if cold and not tame and random.random() < 0.5:
            inputs[: random.integers(1, 4), 0] = _pick(random, ODD)  # nothing good yet
        with np.errstate(over="ignore"):
            result.append(Stretch(used.astype(parameters.dtype), inputs.astype(parameters.dtype), cold))
        done += count
    if isinstance(specification, SupervisedSpecification):
        supervise_scans(specification, result, random, tame=tame)
    return result


def _column(
    random: np.random.Generator, count: int, variable: Variable, near: _About, grid: float, tame: bool
) -> FloatArray:
    """Scans of one input; whole numbers come from the supervisor of :mod:`lostmotion.export.supervised_scans`."""
    if variable.kind == "bool":
        return _flag(random, count, IN_SERVICE.get(variable.name, variable.default))
    return np.zeros(count) if variable.kind == "int" else _signal(random, count, near, grid, odd=not tame)


def _settings(
    random: np.random.Generator, specification: Specification, base: FloatArray, last: FloatArray, grid: float
) -> tuple[FloatArray, FloatArray]:
    """Settings to go on from, and those of this stretch: often the last, or one changed; now and then unusable."""
    reals = np.array([variable.kind == "real" for variable in specification.section("parameter")])
    chance = random.random()
    if chance < 0.15:
        return last, last
    if chance < 0.25:
        coarse = np.round(base / grid) * grid
        usable = np.where(reals, np.where(coarse == 0.0, np.sign(base) * grid, coarse), base)
        return usable, usable
    if chance < 0.3:
        return base, base
    used = last.copy()
    chosen = np.flatnonzero(reals if random.random() < 0.6 or reals.all() else ~reals)
    k = int(_pick(random, chosen))
    kind = specification.section("parameter")[k].kind
    bad = chance > 0.85
    if kind == "bool":
        used[k] = 1.0 - used[k]
    elif kind == "int":
        used[k] = _pick(random, BAD_COUNTS if bad else COUNTS)
    elif bad:
        used[k] = _pick(random, (*ODD, *SIZES, -used[k], -grid))
    elif random.random() < 0.3:
        used[k] = _pick(random, used[reals])
    else:
        used[k] = base[k] * _pick(random, FACTORS)
    return (last if bad else used), used


def _pick(random: np.random.Generator, options: Any) -> Any:
    """One of them; many times faster than Generator.choice."""
    return options[int(random.integers(len(options)))]


def _flag(random: np.random.Generator, count: int, usual: float) -> FloatArray:
    """Mostly as usual; else the other way, or switched seldom or often."""
    chance = random.random()
    if chance < 0.8:
        return np.full(count, usual if chance < 0.7 else 1.0 - usual)
    toggles = random.random(count) < _pick(random, (0.1, 0.5))
    return (np.cumsum(toggles) + usual) % 2.0


def _signal(random: np.random.Generator, count: int, about: _About, grid: float, *, odd: bool) -> FloatArray:
    """A signal of one of several kinds, about the range, the places and the sizes of the settings, on a grid or not."""
    low, high, span = about.low, about.high, about.high - about.low
    size = _pick(random, about.sizes)
    start = random.uniform(low - 0.1 * span, high + 0.1 * span)
    if random.random() < 0.5:
        start = _pick(random, about.places) + _pick(random, (-1.0, -0.5, 0.0, 0.5, 1.0)) * size
    signal: FloatArray
    match random.integers(6):
        case 0:
            signal = start + np.cumsum(random.normal(scale=0.3 * size, size=count))
        case 1:  # there and back by a setting, and by the next number beyond it
            steps = random.choice((size, -size, np.nextafter(size, np.inf), -np.nextafter(size, np.inf)), count)
            signal = np.round(start, 2) + np.cumsum(steps * random.choice((0.0, 0.5, 1.0), count))
        case 2:
            signal = random.uniform(low - 0.2 * span, high + 0.2 * span, size=count)
        case 3:
            wave = np.sin(np.arange(count) * random.uniform(0.01, 1.0))
            signal = start + _pick(random, (0.7, 1.5, 5.0)) * size * wave + random.normal(scale=0.1 * size, size=count)
        case 4:
            signal = start + np.cumsum(random.integers(-3, 4, size=count).astype(np.float64)) * about.grid
        case _:
            signal = np.full(count, start)
    if grid:
        signal = np.round(signal / grid) * grid  # so that it meets thresholds exactly
    if odd and random.random() < 0.5:
        places = random.random(count) < ODD_SHARE
        signal[places] = random.choice(ODD, int(places.sum()))
    return np.asarray(signal, dtype=np.float64)
