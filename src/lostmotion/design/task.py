"""One design problem: plants, limits, criterion; from a length to the best staircase."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.design.coarse import coarser
from lostmotion.design.design_criterion import Criterion
from lostmotion.design.operating_limits import EVERYTHING, Limits
from lostmotion.design.schedule_search import Scene, search
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase
from lostmotion.models import LinearModel

MOST_HOLDS = 30  # usual holds of one block; longer tests repeat it
WORK = 3.0e7  # samples times plants that the search may look at
EVALUATIONS = (60, 2000)  # fewest and most candidates of one search
LOOP_SHARE = 0.5  # of that in closed loop, where a candidate costs twice as much
PER_HOLD, PER_CONSTANT = 6, 10  # coarse samples per shortest hold and per dominant time constant, at least
STEPS = (50.0, 10.0, 5.0)  # grid of the levels: parts of their range, of the zone's width, of the room beside it
FINEST = 1000.0  # parts of their range
ASSURED = 0.8  # share of the plausible plants that must reach what is wanted, where not all must
FAR = 3.0  # times the wanted half-width that no plausible plant must miss
ROUNDS, AGAIN = 3, 0.4  # searches where fresh plants break the limits, and the share of work of the later ones
ROOM = 0.3  # of the overshoot: kept as room in the next search
CHEAP = 1.1  # a staircase drawn in at this loss is good enough
HALVINGS = 7  # of the share of a staircase that keeps the limits: to 1 % of it


@dataclass(frozen=True)
class Task:
    """What is to be designed.

    Parameters
    ----------
    plants : list of Plant
        The model as given, then plausible others; the information is taken over all of them.
    guards : list of Plant
        Extremes that must keep the limits too.
    fresh : list of Plant
        Plausible plants that the search does not see; they judge the result.
    limits : Limits
    criterion : Criterion
    seed : int
    goal : bool
        Whether the wanted half-widths of the criterion were asked for; else the smallest are sought.
    effort : float
        Work of the search, 1 is normal.
    """

    plants: list[Plant]
    guards: list[Plant]
    fresh: list[Plant]
    limits: Limits
    criterion: Criterion
    seed: int
    goal: bool = False
    effort: float = 1.0

    @property
    def everyone(self) -> list[Plant]:
        """All plants that must keep the limits."""
        return self.plants + self.guards + self.fresh

    @property
    def usual(self) -> int:
        """Length of an ordinary hold, samples."""
        return max(self.limits.hold, self.limits.longest // 2)

    def signal(self, stairs: Staircase) -> FloatArray:
        """Samples of a test."""
        return stairs.signal(self.limits.start, self.limits.per_sample)

    def ratio(self, signal: FloatArray) -> float:
        """Half-width over wanted half-width, 1 or less where it is reached.

        By the model as given and four plausible plants in five, with none far beyond.
        """
        table = self.criterion.table(self.plants + self.fresh, signal)
        ratios = (table / self.criterion.goals).max(axis=1)
        enough = np.sort(ratios)[int(np.ceil(ASSURED * ratios.size)) - 1]
        return float(max(enough, ratios[0], ratios.max() / FAR))

    def best(self, samples: int, share: float = 1.0) -> Staircase:
        """Best staircase of this length; every plant keeps the limits, or nothing better than rest was found.

        Where a fresh plant breaks a limit the staircase is drawn in until none does. If that costs much, the plant
        joins the guards, some room is kept at the limits, and the search goes on.
        """
        guards, room = list(self.guards), np.zeros(2)
        rest = Staircase(np.array([self.limits.start]), np.array([samples]))
        found = [(np.inf, rest)]
        for attempt in range(ROUNDS):
            stairs = self._searched(samples, guards, room, share if attempt == 0 else AGAIN * share, attempt)
            if stairs is None:
                break
            over = self._overshoots(stairs)
            if over.max() <= 0.0:
                found.append((self.ratio(self.signal(stairs)), stairs) if len(found) > 1 else (0.0, stairs))
                break
            tamed = self._tamed(stairs)
            found.append((self.ratio(self.signal(tamed)), tamed))
            if found[-1][0] <= CHEAP * self.ratio(self.signal(stairs)):
                break
            guards += [plant for plant, beyond in zip(self.everyone, over, strict=True) if beyond.max() > 0.0]
            room += ROOM * np.maximum(over.max(axis=0), 0.0)
        return min(found, key=lambda pair: pair[0])[1]

    def _overshoots(self, stairs: Staircase) -> FloatArray:
        """How far PV and OP go beyond their limits, shape (plants, 2)."""
        if not self.limits.watched:
            return np.zeros((1, 2))
        signal = self.signal(stairs)
        return np.array([self.limits.overshoot(plant, *plant.trial(signal)) for plant in self.everyone])

    def _tamed(self, stairs: Staircase) -> Staircase:
        """The staircase with its far levels drawn in as little as the limits ask."""
        reach = float(np.abs(stairs.levels - self.limits.start).max())
        allowed, refused = 0.0, 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (allowed + refused)
            if self._overshoots(self._drawn_in(stairs, share * reach)).max() <= 0.0:
                allowed = share
            else:
                refused = share
        return self._drawn_in(stairs, allowed * reach)

    def _drawn_in(self, stairs: Staircase, reach: float) -> Staircase:
        """Levels clipped to the grid points that are not further than `reach` from the start."""
        start, step = self.limits.start, self._step()
        low, high = np.ceil((start - reach) / step) * step, np.floor((start + reach) / step) * step
        levels = np.clip(stairs.levels, low, high) if low <= high else np.full(stairs.levels.size, start)
        return Staircase(levels, stairs.lengths)

    def _searched(
        self, samples: int, guards: list[Plant], room: FloatArray, share: float, attempt: int
    ) -> Staircase | None:
        """One search on the coarse clock; None where the plants break a limit even at rest."""
        factor = self._factor(samples)
        plants = [coarser(plant, factor) for plant in self.plants]
        watched = [coarser(plant, factor) for plant in guards]
        times = max(-(-samples // (MOST_HOLDS * self.usual)), 1)
        length = -(-samples // (times * factor))
        limits = self.limits.tightened(*room).coarser(factor)
        if not limits.kept(plants + watched, np.full(length, limits.start)):
            return None
        scene = Scene(
            plants, watched, limits, self.criterion, self._places(), self._step(), self._repeats(times)
        )  # fmt: skip
        most = share * WORK / (length * len(plants))
        if self.plants[0].controller is not None:
            share, most = LOOP_SHARE * share, LOOP_SHARE * most
        evaluations = max(int(self.effort * min(max(most, EVALUATIONS[0]), share * EVALUATIONS[1])), 1)
        block, _ = search(scene, length, evaluations, np.random.default_rng([self.seed, attempt]))
        return block.slower(factor).repeated(times).cut(samples, self.limits.hold).merged()

    def _factor(self, samples: int) -> int:
        """Samples per coarse sample."""
        if not self.effort or samples < 500:
            return 1
        plant = self.plants[0]
        slowest = dominant(plant.model.linear) / (PER_CONSTANT * (2 if plant.controller else 1))
        return max(1, min(self.limits.hold // PER_HOLD, int(slowest)))

    def _repeats(self, times: int) -> int:
        """Repetitions over which the limits are watched: an integrating process drifts from one to the next."""
        if self.limits.pv == EVERYTHING:
            return 1
        return times if any(plant.integrating for plant in self.plants) else min(times, 2)

    def _places(self) -> FloatArray:
        """Values of the moved signal that put OP at a break point, or in a loop just beyond."""
        if self.plants[0].controller is None:
            return np.array([end for plant in self.plants for end in (plant.zone.left, plant.zone.right)])
        places = []
        low, high = self.limits.levels
        for plant in self.plants:
            zone = plant.zone
            for share in (0.05, 0.2):
                if plant.integrating:
                    places += [plant.pv_now - share * (high - low), plant.pv_now + share * (high - low)]
                    continue
                for beyond in (zone.left - share * zone.width, zone.right + share * zone.width):
                    places.append(plant.model.linear.gain * float(zone(beyond)) + plant.model.offset)
        return np.clip(places, low, high)

    def _step(self) -> float:
        """Grid of the levels: a round number that an operator can enter."""
        low, high = self.limits.levels
        finest, step = (high - low) / FINEST, (high - low) / STEPS[0]
        if self.plants[0].controller is None:
            zone = self.plants[0].zone
            rooms = [zone.width / STEPS[1], *(abs(room) / STEPS[2] for room in (high - zone.right, zone.left - low))]
            step = min(step, max(min(rooms), finest))
        return round_number(step)


def dominant(linear: LinearModel) -> float:
    """Slowest time constant that settles, in samples; at least 1."""
    return max(linear.slowest_lag(), 1.0)


def round_number(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that is not above `value`."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * max(digit for digit in (1.0, 2.0, 5.0) if digit * power <= value * (1 + 1e-9)))
