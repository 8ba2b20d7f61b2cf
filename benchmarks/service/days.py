"""What happens to the loop in service: working hours, wear and repairs, manual stretches, and a faulty record."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from service.plant import AUTO, HAND, HELD, Array, Plant

HOUR = 36_000  # samples of 0.1 s
DAY = 24 * HOUR
WORK = 8 * HOUR  # the first hours of each day
MOVE = 300  # samples between set-point moves
CYCLE, FIRST_REPAIR = 6 * DAY, DAY + 2 * HOUR
NEW = (-1.0, 1.0)
WEAR = (-0.4, 0.6)  # of the break points in one cycle, in working hours only: it comes with movement
HELD_RATE, HELD_LENGTH = 0.3, 8000  # stretches in a block of 100,000, and their mean length
HAND_RATE, HAND_LENGTH = 0.3, 4000
GAP_RATE, GAP_LENGTH = 3.0, 300
STUCK_RATE, STUCK_LENGTH = 1.0, 30
SPIKES, SPIKE_SIZE = 1e-4, 3.0  # share of the samples, deviation: 17 times that of the noise


@dataclass(frozen=True)
class Block:
    """Record as an estimator gets it (n,), the truth behind it, and the samples at which PV got stuck."""

    first: int
    u: Array
    y: Array
    use: Array
    left: Array
    right: Array
    stuck: list[int] = field(default_factory=list)


def repairs(samples: int) -> Array:
    """Samples at which the valve was repaired."""
    return np.arange(FIRST_REPAIR, samples, CYCLE)


def wear(times: Array) -> Array:
    """Share of a cycle's wear at each sample: working hours since the last repair over those of a cycle."""
    days, rest = np.divmod(times, DAY)
    worked = days * WORK + np.minimum(rest, WORK)
    since = (times - FIRST_REPAIR) // CYCLE * CYCLE + FIRST_REPAIR
    days, rest = np.divmod(since, DAY)
    return (worked - days * WORK - np.minimum(rest, WORK)) / (CYCLE // DAY * WORK)


def stretches(n: int, rate: float, length: int, random: np.random.Generator) -> list[slice]:
    """Random pieces of a block; on average `rate` per 100,000 samples, of exponential length."""
    starts = random.integers(0, n, random.poisson(rate * n / 100_000))
    return [slice(start, start + 1 + int(random.exponential(length))) for start in starts]


def repeats(y: Array) -> Array:
    """Samples whose PV is to the last bit that of the sample before: it did not come from the transmitter."""
    return np.concatenate([[False], y[1:] == y[:-1]])


class Service:
    """Makes block after block; memory does not grow."""

    def __init__(self, seed: int) -> None:
        self._random = np.random.default_rng(seed)
        self._plant = Plant()
        self._sample, self._setpoint, self._hand = 0, 0.0, 0.0

    def block(self, n: int) -> Block:
        """Return the next n samples."""
        times = np.arange(self._sample, self._sample + n)
        worn = wear(times)
        left, right = NEW[0] + WEAR[0] * worn, NEW[1] + WEAR[1] * worn
        mode = np.full(n, AUTO)
        for rate, length, what in ((HELD_RATE, HELD_LENGTH, HELD), (HAND_RATE, HAND_LENGTH, HAND)):
            for piece in stretches(n, rate, length, self._random):
                mode[piece] = what
        u, y = self._plant.run(self._reference(times), mode, self._hands(n), left, right, self._random)
        block = Block(self._sample, u, y, mode != HAND, left, right)
        self._spoil(block)
        self._sample += n
        return block

    def _reference(self, times: Array) -> Array:
        """Set point -1, 0 or 1, drawn anew every MOVE samples in working hours, kept at night."""
        moves = np.flatnonzero((times % MOVE == 0) & (times % DAY < WORK))
        drawn = self._random.choice([-1.0, 0.0, 1.0], moves.size)
        values = np.concatenate([[self._setpoint], drawn])
        self._setpoint = float(values[-1])
        return values[np.searchsorted(moves, np.arange(times.size), side="right")]

    def _hands(self, n: int) -> Array:
        """Positions by hand: another level every 500 samples."""
        levels = self._random.uniform(-3.0, 3.0, n // 500 + 1)
        return np.repeat(levels, 500)[:n]

    def _spoil(self, block: Block) -> None:
        """Spikes, stuck values and gaps, in the record only: the controller saw the truth."""
        n, random = block.u.size, self._random
        spikes = random.random(n) < SPIKES
        block.y[spikes] += random.normal(scale=SPIKE_SIZE, size=int(spikes.sum()))
        for piece in stretches(n, STUCK_RATE, STUCK_LENGTH, random):
            block.y[piece] = block.y[piece.start]
            block.stuck.append(block.first + piece.start)
        for piece in stretches(n, GAP_RATE, GAP_LENGTH, random):
            block.y[piece] = np.nan
            if random.random() < 0.5:
                block.u[piece] = np.nan
