"""The search: exchange of levels and holds over the Fisher information, from several starts.

Information about a break point comes from OP on its far side: the derivative of PV with respect to `right` is the
indicator [OP > right] through the process, less what the slopes, the offset and the dynamics explain of it. So good
tests stay just beyond the farthest plausible break points on both sides, with some visits to the inside and to the
ends of the range; the starts are built like that and the exchange finds the shares and the times.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.design.design_criterion import Criterion
from lostmotion.design.operating_limits import Limits
from lostmotion.design.simulated_plant import Plant
from lostmotion.design.staircase import Staircase

STARTS = 3  # the search is local: together they take a third of its work
START_SHARE = 0.12  # of the evaluations, for each start
OUTER_SHARE = 0.1  # of the holds of a start at the ends of the range, and as many inside the zone
FEWEST_HOLDS = 4  # two levels on either side of the zone: a line behind a break point has a place and a slope
MOST_TRIES = 3  # moves per evaluation, where most break a limit


@dataclass(frozen=True)
class Scene:
    """Everything a candidate is judged by.

    Parameters
    ----------
    plants : list of Plant
        Over which the information is taken; all must keep the limits.
    guards : list of Plant
        Further plants that must keep the limits.
    limits : Limits
    criterion : Criterion
    places : ndarray
        Values of the moved signal that put a plant at a break point.
    step : float
        Grid of the levels.
    repeats : int
        Times the staircase is repeated where the limits are watched.
    """

    plants: list[Plant]
    guards: list[Plant]
    limits: Limits
    criterion: Criterion
    places: FloatArray
    step: float
    repeats: int = 1

    def signal(self, stairs: Staircase) -> FloatArray:
        """Samples of a candidate."""
        return stairs.signal(self.limits.start, self.limits.per_sample)

    def allowed(self, stairs: Staircase) -> bool:
        """Whether all limits are kept on all plants."""
        if not self.limits.holds(stairs):
            return False
        return self.limits.kept(self.guards + self.plants, self.signal(stairs.repeated(self.repeats)))

    def score(self, stairs: Staircase) -> float:
        """Criterion, smaller is better; infinite where a limit is broken."""
        if not self.limits.holds(stairs):
            return np.inf
        signal = self.signal(stairs.repeated(self.repeats))
        if not self.limits.kept(self.guards, signal):
            return np.inf
        simulated = self.limits.watched or self.plants[0].controller is not None
        rows, n = [], stairs.samples
        for plant in self.plants:
            op, pv = plant.trial(signal) if simulated else (signal, signal)
            if self.limits.watched and max(self.limits.overshoot(plant, op, pv)) > 0.0:
                return np.inf
            rows.append(self.criterion.half_widths(plant, op[:n], pv[:n]))
        return self.criterion.score(np.array(rows))

    def rounded(self, level: float) -> float:
        """Level on the grid and inside its limits."""
        low, high = self.limits.levels
        return float(min(max(round(level / self.step) * self.step, low), high))


def search(scene: Scene, samples: int, evaluations: int, random: np.random.Generator) -> tuple[Staircase, float]:
    """Best staircase of this length and its score.

    Parameters
    ----------
    scene : Scene
    samples : int
        Length of the test.
    evaluations : int
        Candidates whose information is computed: the work.
    random : Generator
    """
    few = max(int(START_SHARE * evaluations), 1)
    found = []
    for _ in range(STARTS):
        start = first_staircase(scene, samples, random)
        found.append(exchange(scene, start, few, random))
    best, _ = min(found, key=lambda pair: pair[1])
    return exchange(scene, best, max(evaluations - STARTS * few, 1), random)


def first_staircase(scene: Scene, samples: int, random: np.random.Generator) -> Staircase:
    """A start that keeps the limits: levels drawn about the break points, each kept only where it is allowed."""
    limits = scene.limits
    usual = min(max(limits.hold, limits.longest // 2), max(samples // FEWEST_HOLDS, limits.hold))
    count = max(samples // usual, 1)
    lengths = np.full(count, samples // count)
    lengths[: samples - int(lengths.sum())] += 1
    levels = np.full(count, scene.rounded(limits.start))
    if not scene.limits.holds(Staircase(levels, lengths)):
        return Staircase(levels, lengths)
    for k in range(count):
        for wish in _wishes(scene, k, random):
            levels[k] = wish
            part = Staircase(levels[: k + 2], lengths[: k + 2])
            if scene.allowed(part):
                break
            levels[k] = scene.rounded(limits.start)
    return Staircase(levels, lengths)


def _wishes(scene: Scene, k: int, random: np.random.Generator) -> list[float]:
    """Levels to try in turn, on alternating sides; mostly just beyond the farthest plausible break points."""
    low, high = scene.limits.levels
    near, far = float(scene.places.min()), float(scene.places.max())
    middle, spread = 0.5 * (near + far), far - near
    side = 1.0 if k % 2 else -1.0
    edge = far if side > 0 else near
    kind = random.random()
    if kind < OUTER_SHARE:
        first = high if side > 0 else low
    elif kind < 2 * OUTER_SHARE:
        first = middle
    else:
        first = edge + side * spread * random.uniform(-0.15, 0.15)
    other = near if side > 0 else far
    return [scene.rounded(level) for level in (first, edge, other, 0.5 * (first + middle), middle)]


Move = Callable[[Scene, Staircase, np.random.Generator], Staircase | None]


def exchange(scene: Scene, stairs: Staircase, evaluations: int, random: np.random.Generator) -> tuple[Staircase, float]:
    """Try one change after the other and keep what helps; return the best and its score."""
    best = scene.score(stairs)
    done = tries = 0
    while done < evaluations and tries < MOST_TRIES * evaluations:
        tries += 1
        move: Move = MOVES[int(random.choice(len(MOVES), p=SHARES))]
        trial = move(scene, stairs, random)
        if trial is None:
            continue
        score = scene.score(trial)
        done += int(np.isfinite(score))
        if score < best:
            best, stairs = score, trial
    return stairs, best


def _any_level(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:
    return _with_level(scene, stairs, random, random.uniform(*scene.limits.levels))


def _level_at_a_break_point(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:
    spread = max(float(np.ptp(scene.places)), scene.step)
    return _with_level(scene, stairs, random, float(random.choice(scene.places)) + 0.1 * spread * random.normal())


def _level_nearby(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:
    k = int(random.integers(stairs.levels.size))
    move = scene.step * float(random.integers(1, 5)) * float(random.choice([-1.0, 1.0]))
    return _replaced(scene, stairs, k, float(stairs.levels[k]) + move)


def _with_level(scene: Scene, stairs: Staircase, random: np.random.Generator, level: float) -> Staircase | None:
    return _replaced(scene, stairs, int(random.integers(stairs.levels.size)), level)


def _replaced(scene: Scene, stairs: Staircase, k: int, level: float) -> Staircase | None:
    levels = stairs.levels.copy()
    levels[k] = scene.rounded(level)
    return None if levels[k] == stairs.levels[k] else Staircase(levels, stairs.lengths)


def _swap(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:  # noqa: ARG001
    i, j = random.integers(stairs.levels.size, size=2)
    levels = stairs.levels.copy()
    levels[[i, j]] = levels[[j, i]]
    return None if levels[i] == levels[j] else Staircase(levels, stairs.lengths)


def _shift_edge(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:
    if stairs.levels.size < 2:
        return None
    k = int(random.integers(stairs.levels.size - 1))
    move = int(random.integers(1, max(scene.limits.hold // 2, 1) + 1)) * int(random.choice([-1, 1]))
    lengths = stairs.lengths.copy()
    lengths[k] += move
    lengths[k + 1] -= move
    return Staircase(stairs.levels, lengths)


def _split(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:
    k = int(random.integers(stairs.levels.size))
    hold, length = scene.limits.hold, int(stairs.lengths[k])
    if length < 2 * hold:
        return None
    first = int(random.integers(hold, length - hold + 1))
    lengths: IntArray = np.insert(stairs.lengths, k, first)
    lengths[k + 1] -= first
    level = float(random.choice(scene.places)) if random.random() < 0.5 else random.uniform(*scene.limits.levels)
    return Staircase(np.insert(stairs.levels, k, scene.rounded(level)), lengths)


def _join(scene: Scene, stairs: Staircase, random: np.random.Generator) -> Staircase | None:  # noqa: ARG001
    if stairs.levels.size <= FEWEST_HOLDS:
        return None
    k = int(random.integers(stairs.levels.size))
    other = k - 1 if k else 1
    lengths = stairs.lengths.copy()
    lengths[other] += lengths[k]
    return Staircase(np.delete(stairs.levels, k), np.delete(lengths, k))


MOVES: tuple[Move, ...] = (_any_level, _level_at_a_break_point, _level_nearby, _swap, _shift_edge, _split, _join)
SHARES = (0.2, 0.15, 0.2, 0.1, 0.15, 0.1, 0.1)  # of the tries, in the order of MOVES: over half of them move a level
