"""Simulated plants in which one source swings and others swing with it."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from lostmotion.evaluate.plants import MadePlant, random_plant
from lostmotion.evaluate.plants.spread import Spread, spread

SOURCES = ("stiction", "outside", "stiction", "tight tuning", "backlash")  # of plant 0, 1, ..: valves are 60 %
LOOPS, DAYS = (8, 20), 0.25
CLEARLY, OTHERS = 0.25, 2  # share of the variance of so many other loops, at least
OWN = 0.4  # of the source itself
DRAWS, MOST_DRAWS = 400, 4000  # seeds of one plant side by side; backlash seldom swings by itself
UPSTREAM = 4


@dataclass(frozen=True)
class SwingingPlant:
    """A plant and how far its source reaches; `source` is the number of the loop, None: outside."""

    number: int
    kind: str
    plant: MadePlant
    source: int | None
    spread: Spread


def likely_source(seed: int, loops: int) -> int:
    """A loop with a valve of its own that goes on to many others: most others swing alone, and are no case of this."""
    plant = random_plant(seed, loops, DAYS, 0)
    leads = Counter(wire.source for wire in plant.wires)
    own = sorted((n for n in range(loops) if np.isfinite(plant.loops[n].stroke)), key=lambda n: -leads[n])
    return own[seed % min(UPSTREAM, len(own))]


def swinging_plant(number: int, family: int) -> SwingingPlant:
    """Plant `number` of a family: drawn until the oscillation of its source reaches others."""
    kind = SOURCES[number % len(SOURCES)]
    for draw in range(MOST_DRAWS):
        seed = (draw // DRAWS * 100_000 + family * 1000 + number) * DRAWS + draw % DRAWS
        loops = LOOPS[0] + seed * 7 % (LOOPS[1] - LOOPS[0] + 1)
        outside = kind == "outside"
        source = None if outside else likely_source(seed, loops)
        faults, places = ([], []) if source is None else ([kind], [source])
        plant = random_plant(seed, loops, DAYS, faults, places=places, swings=int(outside))
        found = spread(plant, source)
        if found is not None and _swings_and_spreads(found):
            return SwingingPlant(number, kind, plant, source, found)
    raise RuntimeError(f"no plant {number} of family {family} swings within {MOST_DRAWS} draws")


def _swings_and_spreads(found: Spread) -> bool:
    others = sum(share >= CLEARLY for tag, share in found.shares.items() if tag != found.source)
    return others >= OTHERS and found.shares.get(found.source, OWN) >= OWN
