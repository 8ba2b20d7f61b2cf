"""What is known about one signal: range, resolution, flat and straight stretches, spikes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records.limits import (
    FINE_STEP,
    FLAT_RUN,
    LINEAR_RUN,
    LINEAR_TOLERANCE,
    OUTLIER_Z,
)
from lostmotion.records.sampling import Bools, runs


@dataclass(frozen=True)
class SignalFacts:
    """One signal of a record, in its own unit.

    Parameters
    ----------
    name : str
        "OP" or "PV".
    low, high, mean, std : float
        Extremes, mean and standard deviation.
    amplitude : float
        From the 5 % to the 95 % quantile.
    amplitude_of_span : float, optional
        The same as a share of the engineering span; None: unknown.
    levels : int
        Distinct values.
    step : float
        Smallest distance between two of them; 0 for a constant.
    changes : int
        Rows in which the value differs from the row before.
    longest_flat : int
        Samples in the longest run of one value.
    flat_share : float
        Share of samples in runs of 5 or more.
    linear_share : float
        Share of samples on straight, not level, lines of 8 or more.
    spikes : tuple of int
        Rows that jump away and come back at once.
    """

    name: str
    low: float
    high: float
    mean: float
    std: float
    amplitude: float
    amplitude_of_span: float | None
    levels: int
    step: float
    changes: int
    longest_flat: int
    flat_share: float
    linear_share: float
    spikes: tuple[int, ...]

    @property
    def constant(self) -> bool:
        """True where nothing moves."""
        return self.levels < 2


def describe_signal(
    name: str, values: FloatArray, follows: Bools, span: tuple[float, float] | None = None
) -> SignalFacts | None:
    """Describe one signal; None where every sample is missing.

    Parameters
    ----------
    name : str
        Its name.
    values : ndarray, shape (n,)
        Samples; NaN where missing.
    follows : ndarray of bool, shape (n - 1,)
        False where time is missing between a row and its successor.
    span : (float, float), optional
        Engineering limits.

    Examples
    --------
    >>> facts = describe_signal("OP", np.array([0.0, 0.0, 0.0, 0.5, 1.0]), np.ones(4, dtype=bool), (0, 100))
    >>> facts.levels, facts.step, facts.longest_flat
    (3, 0.5, 3)
    """
    known = values[~np.isnan(values)]
    if not len(known):
        return None
    low, high = float(known.min()), float(known.max())
    amplitude = float(np.subtract(*np.quantile(known, [0.95, 0.05])))
    levels, step = resolution(known)
    differences = np.where(follows, np.diff(values), np.nan)
    still = differences == 0.0
    lengths = runs(still)[1] + 1
    return SignalFacts(
        name=name,
        low=low,
        high=high,
        mean=float(known.mean()),
        std=float(known.std()),
        amplitude=amplitude,
        amplitude_of_span=None if span is None else amplitude / (span[1] - span[0]),
        levels=levels,
        step=step,
        changes=int(np.sum(~still & ~np.isnan(differences))),
        longest_flat=int(lengths.max(initial=1)),
        flat_share=float(lengths[lengths >= FLAT_RUN].sum() / len(known)),
        linear_share=_linear_share(differences, high - low, len(known)),
        spikes=find_spikes(differences),
    )


def resolution(known: FloatArray) -> tuple[int, float]:
    """Count distinct values and find their smallest distance; differences by float rounding do not count.

    Examples
    --------
    >>> resolution(np.array([0.1, 0.1 + 1e-15, 0.3, 0.2]))
    (3, 0.1)
    """
    ordered = np.unique(known)
    distances = np.diff(ordered)
    size = max(float(ordered[-1] - ordered[0]), abs(float(ordered[0])) * 1e-6)
    apart = distances[distances > FINE_STEP * size]
    return len(apart) + 1, float(f"{apart.min():.6g}") if len(apart) else 0.0


def find_spikes(differences: FloatArray) -> tuple[int, ...]:
    """Rows that jump away and come back at once, by the robust z-score of two successive differences.

    Examples
    --------
    >>> find_spikes(np.array([0.1, -0.1, 0.1, 9.0, -9.1, 0.1, -0.1]))
    (4,)
    """
    known = differences[~np.isnan(differences) & (differences != 0)]
    if len(known) < 5:
        return ()
    middle = np.median(known)
    scale = 1.4826 * float(np.median(np.abs(known - middle)))
    if scale == 0.0:
        return ()
    z = (differences - middle) / scale
    away, back = z[:-1], z[1:]
    spikes = (np.abs(away) > OUTLIER_Z) & (np.abs(back) > OUTLIER_Z) & (away * back < 0)
    return tuple(int(row) + 1 for row in np.flatnonzero(spikes))


def _linear_share(differences: FloatArray, size: float, samples: int) -> float:
    moving = differences[~np.isnan(differences) & (differences != 0)]
    if len(moving) < LINEAR_RUN:
        return 0.0
    tolerance = LINEAR_TOLERANCE * float(moving.std()) + FINE_STEP * size
    straight = (np.abs(np.diff(differences)) <= tolerance) & (np.abs(differences[1:]) > tolerance)
    lengths = runs(straight)[1] + 2
    return float(lengths[lengths >= LINEAR_RUN].sum() / samples)
