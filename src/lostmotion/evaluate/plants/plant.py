"""MadePlant: loops that disturb each other, simulated day by day, and what a historian keeps of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from functools import cached_property

import numpy as np

from lostmotion.arguments import not_negative, positive, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.evaluate.plants import operators
from lostmotion.evaluate.plants.disturbances import SHAPES, Swing
from lostmotion.evaluate.plants.faults import SensorFault, faulty, wanted, worked
from lostmotion.evaluate.plants.historian import DATA, ILL
from lostmotion.evaluate.plants.made_loop import MadeLoop
from lostmotion.evaluate.plants.network import Wire, network
from lostmotion.evaluate.plants.recorded import loop_record
from lostmotion.evaluate.plants.simulated import Progress, Simulated, simulated
from lostmotion.evaluate.plants.truth import CAUSES, SENSORS, LoopTruth
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord

BEGAN = datetime(2026, 3, 2, tzinfo=UTC)  # a Monday
DAY = 86_400.0
MOST_DAYS = 3660.0  # ten years of a plant
OUTSIDE = "outside"
SWING_SIZE = (1.0, 5.0)  # % of OP
SWING_PERIOD = (120.0, 2400.0)  # seconds
REACHED = (1, 3)  # loops that an outside swing enters
WEIGHTS = (0.5, 1.0, 1.0, 1.0, 2.0, 3.0)


@dataclass(frozen=True, eq=False)
class MadePlant:
    """A plant with its faults.

    Attributes
    ----------
    seed : int
    loops : tuple of MadeLoop
        Faults of valves and of tuning included.
    wires : tuple of Wire
        What disturbs what.
    faults : tuple of str
        Of each loop; "none".
    sensors : tuple of SensorFault or None
        Of each loop.
    swings : tuple of Swing
        From outside.
    data : tuple of str
        What the historian does to each loop: of `historian.DATA`, or "".
    weights : tuple of float
        What each loop is worth.
    dt, seconds : float
    healthy : tuple of MadeLoop
        The loops without their faults.
    moves : float or None
        New set points a day, about, of each loop that has them from no other; None: most loops get none.
    """

    seed: int
    loops: tuple[MadeLoop, ...]
    wires: tuple[Wire, ...]
    faults: tuple[str, ...]
    sensors: tuple[SensorFault | None, ...]
    swings: tuple[Swing, ...]
    data: tuple[str, ...]
    weights: tuple[float, ...]
    dt: float
    seconds: float
    healthy: tuple[MadeLoop, ...] = field(repr=False, default=())
    moves: float | None = None

    @property
    def rows(self) -> int:
        """Samples of each loop."""
        return round(self.seconds / self.dt)

    @cached_property
    def signals(self) -> Simulated:
        """What really happened, in % of span; simulated when first asked for."""
        return simulated(self)

    def simulate(self, progress: Progress) -> Simulated:
        """The same; `progress` is told the share that is done."""
        if "signals" not in self.__dict__:
            self.__dict__["signals"] = simulated(self, progress)
        return self.signals

    def events(self) -> FloatArray:
        """What the operators do."""
        found: list[tuple[float, ...]] = []
        for number, loop in enumerate(self.loops):
            random = np.random.default_rng([self.seed, number, 2])
            busy = self.faults[number] != "none"
            found += operators.events(random, number, loop, self.seconds, self.dt, busy, self.moves)
        return operators.table(found)

    def record(self, number: int) -> LoopRecord:
        """What the historian has of a loop, in engineering units."""
        loop, random = self.loops[number], np.random.default_rng([self.seed, number, 7])
        signals = self.signals.of(number)
        return loop_record(random, loop, signals, self.data[number], self.dt, BEGAN)

    def records(self) -> Iterator[LoopRecord]:
        """Records of all loops, one after another."""
        return (self.record(number) for number in range(len(self.loops)))

    def plant_loops(self) -> tuple[PlantLoop, ...]:
        """The loops as a list of a plant has them."""
        return tuple(
            PlantLoop(
                loop.tag, f"{loop.tag}.OP", f"{loop.tag}.PV", f"{loop.tag}.SP", f"{loop.tag}.MODE", loop.loop_type,
                (0.0, 100.0), loop.pv_span, "%", loop.pv_unit, loop.area, weight,
            )
            for loop, weight in zip(self.loops, self.weights, strict=True)
        )  # fmt: skip

    def truth(self) -> tuple[LoopTruth, ...]:
        """Truth of each loop; of what swings with what see :func:`lostmotion.evaluate.plants.spread.spread`."""
        manual = self.signals.manual
        return tuple(
            LoopTruth(
                loop.tag, loop.area, loop.loop_type, fault, CAUSES.get(fault, "none"),
                float(getattr(loop.actuator, "width", getattr(loop.actuator, "band", 0.0))),
                float(getattr(loop.actuator, "jump", 0.0)), data=self.data[number], manual=float(manual[number]),
            )
            for number, (loop, fault) in enumerate(zip(self.loops, self.faults, strict=True))
        )  # fmt: skip

    def without(self, number: int | None) -> MadePlant:
        """The same plant with the same luck, with one loop in order; None: without the swings from outside."""
        if number is None:
            return replace(self, swings=())
        loops, faults, sensors = list(self.loops), list(self.faults), list(self.sensors)
        loops[number], faults[number], sensors[number] = self.healthy[number], "none", None
        return replace(self, loops=tuple(loops), faults=tuple(faults), sensors=tuple(sensors))


def random_plant(
    seed: int,
    loops: int = 50,
    days: float = 2.0,
    faults: int | Sequence[str] = 10,
    *,
    places: Sequence[int] | None = None,
    swings: int = 0,
    dt: float = 1.0,
    moves: float | None = None,
) -> MadePlant:
    """Draw a plant.

    Parameters
    ----------
    seed : int
        The same seed, the same plant, to the last digit.
    loops : int
        At least 2.
    days : float
    faults : int or sequence of str
        How many of the usual mixture, or their names, of ``plants.FAULTS``. Each gets a loop of its own.
    places : sequence of int, optional
        Number of the loop of each fault. None: drawn.
    swings : int
        Oscillations that come from outside.
    dt : float
        Seconds of a row.
    moves : float, optional
        New set points a day, about, of each loop that has them from no other, by operators and recipes. None: a third
        of the loops get one to twelve, and the others none.

    Raises
    ------
    ParameterError
        More faults than loops that can have them, or a number outside its range.

    Examples
    --------
    >>> plant = random_plant(3, loops=8, days=0.02, faults=["stiction"])
    >>> plant.rows, sorted(set(plant.faults))
    (1728, ['none', 'stiction'])
    """
    seed, loops = whole("seed", seed, 0), whole("loops", loops, 2)
    seconds, dt = DAY * positive("days", days), positive("dt", dt)
    if seconds > MOST_DAYS * DAY:
        raise ParameterError.expected(f"at most {MOST_DAYS:g} days", days, "give less")
    if dt > seconds:
        raise ParameterError.expected(f"dt of at most {seconds:g} s, the days recorded", dt, "give more days")
    kinds = wanted(faults)
    moves = None if moves is None else not_negative("moves", moves)
    made, wires = network(np.random.default_rng([seed, 1]), loops)
    rng = np.random.default_rng([seed, 4])
    places = _places(rng, made, kinds) if places is None else places
    ill, in_order, named = list(made), list(made), ["none"] * loops
    sensors: list[SensorFault | None] = [None] * loops
    for place, kind in zip(places, kinds, strict=True):
        ill[place], sensors[place] = faulty(rng, made[place], kind, dt)
        in_order[place] = worked(made[place], ill[place])
        named[place] = kind
    outside = tuple(one for _ in range(swings) for one in _swing(rng, made))
    data = [str(rng.choice(DATA)) if rng.random() < ILL and fault == "none" else "" for fault in named]
    weights = tuple(float(rng.choice(WEIGHTS)) for _ in made)
    return MadePlant(
        seed,
        tuple(ill),
        wires,
        tuple(named),
        tuple(sensors),
        outside,
        tuple(data),
        weights,
        dt,
        seconds,
        tuple(in_order),
        moves,
    )


def _places(rng: np.random.Generator, made: Sequence[MadeLoop], kinds: Sequence[str]) -> list[int]:
    """A loop for each fault: of a valve or its tuning only where the loop has a valve of its own."""
    free = [int(place) for place in rng.permutation(len(made))]
    found: list[int] = []
    for kind in kinds:
        fit = [place for place in free if kind in SENSORS or np.isfinite(made[place].stroke)]
        if not fit:
            remedy = "ask for fewer faults, or more loops"
            raise ParameterError.expected(f"a loop for each of {len(kinds)} faults", f"{len(made)} loops", remedy)
        found.append(fit[0])
        free.remove(fit[0])
    return found


def _swing(rng: np.random.Generator, made: Sequence[MadeLoop]) -> list[Swing]:
    """One oscillation from outside, on some loops that are slow enough for it to matter and not to be in order."""
    period = float(np.exp(rng.uniform(*np.log(SWING_PERIOD))))
    shape, seed = str(rng.choice(SHAPES)), int(rng.integers(2**31))
    some = rng.choice(len(made), size=min(int(rng.integers(REACHED[0], REACHED[1] + 1)), len(made)), replace=False)
    return [
        Swing(int(loop), period, float(rng.uniform(*SWING_SIZE)), float(rng.uniform(0.0, 2.0 * np.pi)), shape, seed)
        for loop in some
    ]
