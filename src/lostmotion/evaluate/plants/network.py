"""Which loop disturbs which: streams that go on, headers that are shared, a recycle, cascades."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.evaluate.plants.made_loop import LETTERS, TYPES, MadeLoop, made_loop, share
from lostmotion.kernels import coupled_loops as kernel

PER_AREA = (6, 14)  # loops
MIX = {"flow": 0.42, "pressure": 0.17, "level": 0.2, "temperature": 0.21}
CASCADES = 0.35  # of the levels and temperatures that have a flow of their own to set
BACK = 3  # loops upstream at most that disturb one
RECYCLES = 0.6  # of the plants
STRONGEST = 0.9  # % of load per % of the signal
STREAM_LAGS = (2.0, 60.0)  # seconds a stream mixes on its way; a recycle takes ten times as long
STREAM_DELAYS = (1.0, 20.0)
# Signal that goes on, by the types it comes from and goes to, and how strongly; a pair that is not here does not meet.
MEETS = {
    ("flow", "flow"): ("pv", -0.4, -0.1),  # shared header
    ("flow", "pressure"): ("pv", -0.6, 0.6),
    ("flow", "level"): ("pv", 0.3, 0.9),
    ("flow", "temperature"): ("pv", -0.8, 0.6),
    ("pressure", "flow"): ("pv", 0.3, 0.9),  # what pushes
    ("pressure", "pressure"): ("pv", 0.2, 0.7),
    ("pressure", "level"): ("pv", 0.1, 0.4),
    ("pressure", "temperature"): ("pv", 0.2, 0.7),  # boiling point
    ("level", "flow"): ("flow", 0.2, 0.7),  # what the vessel lets out
    ("level", "pressure"): ("flow", 0.1, 0.5),
    ("level", "level"): ("flow", 0.4, 1.0),
    ("level", "temperature"): ("flow", -0.8, 0.8),
    ("temperature", "flow"): ("flow", -0.3, -0.1),  # steam taken from the header
    ("temperature", "pressure"): ("pv", 0.2, 0.7),
    ("temperature", "level"): ("pv", -0.3, 0.3),
    ("temperature", "temperature"): ("pv", 0.2, 0.8),
}


@dataclass(frozen=True)
class Wire:
    """A signal of one loop that disturbs another.

    Attributes
    ----------
    source, target : int
        Numbers of the loops.
    what : str
        "pv", or "flow": what goes through the valve.
    gain, lag, delay : float
        % of load (in units of OP of the target) per %, seconds, seconds.
    """

    source: int
    target: int
    what: str
    gain: float
    lag: float
    delay: float


def network(rng: np.random.Generator, loops: int) -> tuple[tuple[MadeLoop, ...], tuple[Wire, ...]]:
    """Loops of a plant in areas, each from upstream to downstream, and what goes on between them."""
    made: list[MadeLoop] = []
    firsts: list[int] = []
    while len(made) < loops:
        firsts.append(len(made))
        some = min(int(rng.integers(PER_AREA[0], PER_AREA[1] + 1)), loops - len(made))
        made += _area(rng, 100 * len(firsts), len(made), some)
    wires = [wire for first, behind in zip(firsts, [*firsts[1:], loops], strict=True)
             for target in range(first + 1, behind) for wire in _upstream(rng, made, first, target)]  # fmt: skip
    for before, after in pairwise(firsts):  # an area feeds the next
        wires += _wire(rng, made, after - 1, after) + _wire(rng, made, int(rng.integers(before, after)), after)
    if rng.random() < RECYCLES and loops > PER_AREA[0]:
        back = _wire(rng, made, loops - 1, int(rng.integers(0, max(loops // 3, 1))))
        wires += [replace(one, lag=10.0 * one.lag, delay=10.0 * one.delay, gain=0.5 * one.gain) for one in back]
    return tuple(made), tuple(_with_cascades(made, wires))


def tables(loops: Sequence[MadeLoop], wires: Sequence[Wire], dt: float) -> tuple[FloatArray, IntArray, FloatArray]:
    """Arrays for :mod:`lostmotion.kernels.coupled_loops`."""
    rows = np.array([loop.row(dt) for loop in loops])
    numbers = [
        (one.source, one.target, kernel.PV if one.what == "pv" else kernel.FLOW, max(round(one.delay / dt), 1))
        for one in wires
    ]
    weights = [(one.gain, share(dt, one.lag)) for one in wires]
    return rows, np.array(numbers, dtype=np.int64).reshape(-1, 4), np.array(weights).reshape(-1, 2)


def _area(rng: np.random.Generator, number: int, before: int, some: int) -> list[MadeLoop]:
    """Loops of one area; a level or a temperature behind a flow may set it."""
    area = f"Unit {number}"
    types = rng.choice(TYPES, size=some, p=list(MIX.values()))
    made: list[MadeLoop] = []
    for place, kind in enumerate(types):
        loop = made_loop(rng, f"{LETTERS[kind]}IC-{number + place + 1}", area, str(kind))
        last = made[-1] if made else None
        may = last is not None and last.loop_type in ("level", "temperature") and kind == "flow"
        if last is not None and may and rng.random() < CASCADES:
            loop = replace(loop, master=before + place - 1, ratio=float(rng.uniform(0.7, 1.2)))
            made[-1] = _through(last, loop)
        made.append(loop)
    return made


def _through(master: MadeLoop, slave: MadeLoop) -> MadeLoop:
    """A master works through the flow that its slave controls: no valve of its own, the slave's pace in its own."""
    slow = slave.pace + slave.sensor
    if master.integrates:
        late = master.lags[0] + master.dead_time + master.sensor + slow
        closed = max(6.0 * late, 0.15 * master.lags[1])
        kp, ti = master.lags[1] / (closed + late) / (master.gain * slave.ratio), 4.0 * (closed + late)
    else:
        late = master.lags[1] + master.dead_time + master.sensor + slow
        closed = 2.5 * late
        kp = master.lags[0] / (closed + late) / (master.gain * slave.ratio)
        ti = min(master.lags[0], 4.0 * (closed + late))
    return replace(master, kp=float(np.clip(kp, -12.0, 12.0)), ti=ti, stroke=math.inf)


def _upstream(rng: np.random.Generator, made: Sequence[MadeLoop], first: int, target: int) -> list[Wire]:
    """One or two of the loops just upstream."""
    near = range(max(first, target - BACK), target)
    chosen = rng.choice(list(near), size=min(len(near), int(rng.integers(1, 3))), replace=False)
    return [wire for source in chosen for wire in _wire(rng, made, int(source), target)]


def _wire(rng: np.random.Generator, made: Sequence[MadeLoop], source: int, target: int) -> list[Wire]:
    if source == target:
        return []
    what, low, high = MEETS[made[source].loop_type, made[target].loop_type]
    gain = float(rng.uniform(low, high))
    lag, delay = (float(np.exp(rng.uniform(*np.log(limits)))) for limits in (STREAM_LAGS, STREAM_DELAYS))
    return [Wire(source, target, what, float(np.clip(gain, -STRONGEST, STRONGEST)), lag, delay)]


def _with_cascades(made: Sequence[MadeLoop], wires: Sequence[Wire]) -> list[Wire]:
    """A master moves its process by the flow of its slave, and in no other way; nothing of it goes to the slave."""
    slaves = {one.master: number for number, one in enumerate(made) if one.master >= 0}
    kept = [one for one in wires if slaves.get(one.source) != one.target and slaves.get(one.target) != one.source]
    flows = [Wire(slave, master, "pv", 1.0 / made[slave].ratio, 0.0, 0.0) for master, slave in slaves.items()]
    return kept + flows
