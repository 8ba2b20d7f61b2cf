"""Scans that try everything: the inputs a block meets in a plant, and those it should never meet.

Made from the specification alone, the same for the same seed. A scenario is a list of stretches, each with its own
settings; the state goes on from one to the next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.compensate.specification import Specification

FloatArray = npt.NDArray[np.float64]
ODD = (np.nan, np.inf, -np.inf, 1e30, -1e30, 1e308, -1e308, 1e-310, -0.0)
ODD_SHARE = 0.02
WHOLE = (-3.0, -1.0, 0.0, 1.0, 2.0, 3.0, 7.0, 1000.0, 16777216.0)
FACTORS = (0.0, 0.3, 0.9, 1.0, 1.1, 2.0, -1.0)


@dataclass(frozen=True)
class Stretch:
    """Scans with one set of settings: parameters (n_parameters,), inputs (n, n_inputs), both of the block's type."""

    parameters: npt.NDArray[np.floating[Any]]
    inputs: npt.NDArray[np.floating[Any]]


def scenario(
    specification: Specification,
    parameters: npt.NDArray[np.floating[Any]],
    rows: int,
    seed: int = 0,
    *,
    tame: bool = False,
) -> list[Stretch]:
    """Stretches of about 200 scans, `rows` in all.

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
    names = [variable.name for variable in specification.section("parameter")]
    low, high = base[names.index("LOW")], base[names.index("HIGH")]
    sizes = [abs(value) for name, value in zip(names, base, strict=True) if name not in ("LOW", "HIGH") and value]
    result, done = [], 0
    while done < rows:
        count = int(min(rows - done, random.integers(1, 400)))
        settings = base if tame or random.random() < 0.4 else _settings(random, specification, base)
        columns = [
            _flag(random, count, variable.default)
            if variable.kind == "bool"
            else _signal(random, count, low, high, sizes, odd=not tame)
            for variable in specification.section("input")
        ]
        inputs = np.column_stack(columns)
        with np.errstate(over="ignore"):
            result.append(Stretch(settings.astype(parameters.dtype), inputs.astype(parameters.dtype)))
        done += count
    return result


def _settings(random: np.random.Generator, specification: Specification, base: FloatArray) -> FloatArray:
    """Some settings changed, now and then to what no setting may be."""
    result = base.copy()
    for k, variable in enumerate(specification.section("parameter")):
        if random.random() > 0.15:
            continue
        if variable.kind == "bool":
            result[k] = random.integers(2)
        elif variable.kind == "int":
            result[k] = random.choice(WHOLE)
        elif random.random() < 0.05:
            result[k] = random.choice(ODD)
        else:
            result[k] *= random.choice(FACTORS)
    return result


def _flag(random: np.random.Generator, count: int, default: float) -> FloatArray:
    """Switched seldom, often, or not at all."""
    if random.random() < 0.5:
        return np.full(count, default if random.random() < 0.3 else float(random.random() < 0.7))
    toggles = random.random(count) < random.choice((0.01, 0.1, 0.5))
    return (np.cumsum(toggles) + random.integers(2)) % 2.0


def _signal(
    random: np.random.Generator, count: int, low: float, high: float, sizes: list[float], *, odd: bool
) -> FloatArray:
    """A signal of one of several kinds, about the range low .. high and the sizes of the settings."""
    span = high - low
    start = random.uniform(low - 0.1 * span, high + 0.1 * span)
    size = random.choice(sizes) if sizes else 0.01 * span
    match random.integers(6):
        case 0:
            signal = start + np.cumsum(random.normal(scale=0.3 * size, size=count))
        case 1:  # there and back by a setting, and by the next number beyond it
            steps = random.choice((size, -size, np.nextafter(size, np.inf), -np.nextafter(size, np.inf)), count)
            signal = np.round(start) + np.cumsum(steps * random.choice((0.0, 0.5, 1.0), count))
        case 2:
            signal = random.uniform(low - 0.2 * span, high + 0.2 * span, size=count)
        case 3:
            wave = np.sin(np.arange(count) * random.uniform(0.01, 1.0))
            signal = start + random.choice((0.7, 1.5, 5.0)) * size * wave + random.normal(scale=0.1 * size, size=count)
        case 4:
            signal = np.round(start + np.cumsum(random.integers(-1, 2, size=count)) * 0.5, 1)
        case _:
            signal = np.full(count, start)
    if odd and random.random() < 0.5:
        places = random.random(count) < ODD_SHARE
        signal[places] = random.choice(ODD, int(places.sum()))
    return np.asarray(signal, dtype=np.float64)
