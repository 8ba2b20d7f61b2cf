"""A staircase of levels and holds: what an operator or a sequence can carry out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray


@dataclass(frozen=True, eq=False)
class Staircase:
    """Levels and the samples from the start of one move to the start of the next.

    Parameters
    ----------
    levels : ndarray, shape (k,)
    lengths : ndarray of int, shape (k,)
    """

    levels: FloatArray
    lengths: IntArray

    @property
    def samples(self) -> int:
        """Length of the signal."""
        return int(self.lengths.sum())

    def signal(self, start: float, per_sample: float = np.inf) -> FloatArray:
        """Samples (n,): each move begins at its hold and goes by at most `per_sample`, from `start` on."""
        if np.isinf(per_sample):
            return np.repeat(self.levels, self.lengths)
        parts, value = [], start
        for level, length in zip(self.levels.tolist(), self.lengths.tolist(), strict=True):
            reach = per_sample * np.arange(1, length + 1)
            ramp = value + np.sign(level - value) * np.minimum(reach, abs(level - value))
            parts.append(ramp)
            value = float(ramp[-1])
        return np.concatenate(parts)

    def ramps(self, start: float, per_sample: float) -> IntArray:
        """Samples before each level is reached, shape (k,)."""
        moves = np.abs(np.diff(self.levels, prepend=start))
        if np.isinf(per_sample):
            return np.zeros(moves.size, dtype=np.int64)
        return np.maximum(np.ceil(moves / per_sample - 1e-9).astype(np.int64) - 1, 0)

    def slower(self, factor: int) -> Staircase:
        """The same staircase on a clock that is `factor` times finer."""
        return Staircase(self.levels, self.lengths * factor)

    def repeated(self, times: int) -> Staircase:
        """The staircase `times` times after itself."""
        return Staircase(np.tile(self.levels, times), np.tile(self.lengths, times))

    def cut(self, samples: int, shortest: int) -> Staircase:
        """The first `samples` samples; the last hold takes in a rest that is shorter than `shortest`."""
        ends = np.cumsum(self.lengths)
        count = int(np.searchsorted(ends, samples)) + 1
        levels, lengths = self.levels[:count].copy(), self.lengths[:count].copy()
        lengths[-1] = samples - int(lengths[:-1].sum())
        if lengths[-1] < shortest and count > 1:
            lengths[-2] += lengths[-1]
            levels, lengths = levels[:-1], lengths[:-1]
        return Staircase(levels, lengths)

    def until(self, samples: int, shortest: int) -> Staircase:
        """The first `samples` samples, or more: until the hold that is reached has lasted `shortest`."""
        ends = np.cumsum(self.lengths)
        count = min(int(np.searchsorted(ends, samples)), ends.size - 1)
        lengths = self.lengths[: count + 1].copy()
        before = int(ends[count - 1]) if count else 0
        lengths[-1] = min(max(samples - before, shortest), int(lengths[-1]))
        return Staircase(self.levels[: count + 1], lengths)

    def merged(self) -> Staircase:
        """Without moves from a level to itself."""
        first = np.concatenate([[True], np.diff(self.levels) != 0])
        starts = np.flatnonzero(first)
        return Staircase(self.levels[starts], np.add.reduceat(self.lengths, starts))
