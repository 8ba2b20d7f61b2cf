"""Evidence of many records of one valve: what they say together of its kind and size.

Each record says how likely every size is (:mod:`.record_profile`). The lost motion is that of the valve, but it need
not be the same to a percent in every record: sizes scatter about a common one with a deviation tau on a logarithmic
axis (random effects; DerSimonian and Laird, 1986, Controlled Clinical Trials 7), which is summed over with its
likelihood, so that records which differ more than their intervals allow give a wider interval. And a record may be
wild: with a probability of WILD it tells nothing of the valve but what any kind of any size would, so a record that
speaks against what all others say takes no more than log(1 / WILD) = 3 of log-likelihood.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import logsumexp

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.pooled.record_profile import RecordProfile
from lostmotion.identify.actuators.kind import NO_FAULT, faults, kind_of
from lostmotion.identify.unseen_moves import beyond_unseen, within_unseen

WILD = 0.05  # of single diagnoses that name a kind it is wrong in so many
STEP = 0.005  # of the grid of sizes, on a logarithmic axis: a deviation below it is of no use to anyone
SCATTER = np.array([0.0, 0.02, 0.04, 0.08, 0.15, 0.25, 0.4])  # deviations tau that are tried
TYPICAL_SCATTER = 0.1  # scale of their prior (half Cauchy): a valve keeps its lost motion within some 10 %
LEVEL = 0.95
FALL = 0.5 * 1.645**2  # of log-likelihood, at which a size is excluded (one-sided, as in a single record)
WORTH = 0.5  # of a difference between models, as in the choice of the kind of one record: neither is the process
LOWEST = -700.0  # of a logarithm


@dataclass(frozen=True)
class SizeEvidence:
    """What all records say of one kind that has a size.

    Attributes
    ----------
    sizes : ndarray, shape (g,)
        Common size, units of OP.
    parts : ndarray, shape (records, tau, g)
        Log-likelihood of each record over that of a linear process for every scatter and size.
    at_once : ndarray, shape (records, g)
        The same without scatter, with small gains and losses, none beyond log(1 / WILD); 0 of records in which nothing
        but PV moves OP, or PV answers nothing that is new in OP.
    unseen : float
        What OP does between the rows, or may do: in all records alike, so no average takes it away.
    sticks : bool
        Whether the kind has a memory of it.
    doubt : float
        What of the upper end of its interval is there only as nobody knows whether OP does anything there.
    moves : float
        What counts so for a size that is told: `unseen`, or more.
    """

    sizes: FloatArray
    parts: FloatArray
    at_once: FloatArray
    unseen: float = 0.0
    sticks: bool = True
    doubt: float = 0.0
    moves: float = 0.0

    def table(self, without: int | None = None) -> FloatArray:
        """Log of prior times likelihood, shape (tau, g); without one record, if asked for."""
        parts = self.parts if without is None else np.delete(self.parts, without, axis=0)
        return np.asarray(parts.sum(axis=0) + _log_prior(len(self.sizes)))

    def total(self, without: int | None = None) -> float:
        """Log of the marginal likelihood over that of a linear process."""
        return float(logsumexp(self.table(without)))

    @cached_property
    def posterior(self) -> FloatArray:
        """Probability of each size."""
        table = self.table()
        return np.asarray(np.exp(logsumexp(table, axis=0) - logsumexp(table)))

    @property
    def scatter(self) -> float:
        """Expected deviation of the size from record to record, relative."""
        table = self.table()
        return float(np.exp(logsumexp(table, axis=1) - logsumexp(table)) @ SCATTER)

    def size(self, without: int | None = None) -> float:
        """Median of the common size."""
        table = self.table(without)
        return self._quantile(np.exp(logsumexp(table, axis=0) - logsumexp(table)), 0.5)

    def interval(self, level: float = LEVEL) -> tuple[float, float]:
        """Where the common size lies with this probability."""
        tail = 0.5 * (1.0 - level)
        low, high = self._quantile(self.posterior, tail), self._quantile(self.posterior, 1.0 - tail)
        return within_unseen(low, self.moves, self.sticks), beyond_unseen(high, self.moves, self.sticks)

    @property
    def largest_known(self) -> float:
        """Upper end of the interval without what is not known to be there."""
        return self.interval()[1] - self.doubt

    def _quantile(self, weights: FloatArray, share: float) -> float:
        below = np.cumsum(weights) - 0.5 * weights
        return float(np.exp(np.interp(share, below, np.log(self.sizes))))

    def gains(self) -> FloatArray:
        """What each record adds at the most probable place, over a linear process; shape (records,)."""
        table = self.table()
        tau, at = np.unravel_index(int(np.argmax(table)), table.shape)
        return np.asarray(self.parts[:, tau, at])

    def largest(self) -> float:
        """Largest size that all records together do not exclude; inf where none is."""
        sums = WORTH * self.at_once.sum(axis=0)
        left = np.flatnonzero(sums >= -FALL)
        if left.size and left[-1] == len(sums) - 1:
            return float(np.inf)
        return beyond_unseen(float(self.sizes[left[-1] if left.size else 0]), self.unseen, self.sticks)


@dataclass(frozen=True)
class Evidence:
    """What all records say together.

    Attributes
    ----------
    sized : dict of SizeEvidence
        Of every kind that has a size.
    others : dict of ndarray, shape (records,)
        Log-likelihood over that of a linear process of the kinds without one.
    swing : float
        Of OP from end to end, in most records; 0 where it does not swing there.
    hidden : str
        Why most records tell no size of a valve that sticks; empty where they do.
    """

    sized: dict[str, SizeEvidence]
    others: dict[str, FloatArray]
    swing: float = 0.0
    hidden: str = ""

    @property
    def records(self) -> int:
        """How many there are."""
        return len(next(iter(self.sized.values())).parts)

    def totals(self, without: int | None = None) -> dict[str, float]:
        """Log-likelihood of every kind over that of a linear process; without one record, if asked for."""
        found = {NO_FAULT: 0.0} | {name: one.total(without) for name, one in self.sized.items()}
        kept = {name: values if without is None else np.delete(values, without) for name, values in self.others.items()}
        return found | {name: float(values.sum()) for name, values in kept.items()}

    def gains(self, kind: str) -> FloatArray:
        """What each record adds for a kind over a linear process; shape (records,)."""
        return self.sized[kind].gains() if kind in self.sized else self.others[kind]


def sizes_between(low: float, high: float) -> FloatArray:
    """Grid of sizes."""
    return np.geomspace(low, high, max(int(np.ceil(np.log(high / low) / STEP)), 1) + 1)


def evidence_of(profiles: Sequence[RecordProfile], low: float, high: float) -> Evidence:
    """Sum up.

    Parameters
    ----------
    profiles : sequence of RecordProfile
    low, high : float
        Sizes between which the common one lies, units of OP.
    """
    sizes = sizes_between(low, high)
    sized = [kind.name for kind in faults() if kind.size is not None]
    rest = [kind.name for kind in faults() if kind.size is None]
    curves = {name: np.array([one.curves[name].firm_on(sizes, STEP) for one in profiles]) for name in sized}
    tells = np.array([not one.fed_back for one in profiles])[:, None]
    whole = {name: tells * np.array([one.curves[name].on(sizes, STEP) for one in profiles]) for name in sized}
    free = {name: np.array([one.gains.get(name, 0.0) for one in profiles]) for name in rest}
    anything = _anything(curves, free)
    linear = _or_wild(np.zeros(len(profiles)), anything)
    unseen = {sticks: float(np.median([one.unseen.about(sticks) for one in profiles])) for sticks in (True, False)}
    moves = {s: float(np.median([one.unseen.of_size(s, closed=True) for one in profiles])) for s in (True, False)}
    doubt = {s: -float(np.median([one.unseen.doubted(0.0, moves[s], s) for one in profiles])) for s in moves}
    scattered = {name: _scattered(values, sizes) for name, values in curves.items()}
    return Evidence(
        {
            name: SizeEvidence(
                sizes,
                _or_wild(values, anything[:, None, None]) - linear[:, None, None],
                np.clip(whole[name], np.log(WILD), -np.log(WILD)),
                unseen[kind_of(name).sticks],
                kind_of(name).sticks,
                doubt[kind_of(name).sticks],
                moves[kind_of(name).sticks],
            )
            for name, values in scattered.items()
        },
        {name: _or_wild(values, anything) - linear for name, values in free.items()},
        float(np.median([one.swing for one in profiles])),
        max((one.hides_size for one in profiles), key=[one.hides_size for one in profiles].count),
    )


def _anything(curves: dict[str, FloatArray], free: dict[str, FloatArray]) -> FloatArray:
    """Log-likelihood of the best kind of any size, each record by itself; at least that of a linear process."""
    found = [logsumexp(values, axis=1) - np.log(values.shape[1]) for values in curves.values()]
    return np.asarray(np.max([*found, *free.values(), np.zeros(len(next(iter(curves.values()))))], axis=0))


def _or_wild(values: FloatArray, anything: FloatArray) -> FloatArray:
    """Log-likelihood of a record that may be wild."""
    return np.asarray(np.logaddexp(np.log1p(-WILD) + values, np.log(WILD) + anything))


def _scattered(curves: FloatArray, sizes: FloatArray) -> FloatArray:
    """Curves of all records smoothed by each scatter; shape (records, tau, sizes)."""
    logs = np.log(sizes)
    top = curves.max(axis=1, keepdims=True)
    flat = np.exp(np.maximum(curves - top, LOWEST))
    found = []
    for tau in SCATTER:
        if tau == 0.0:
            found.append(curves)
            continue
        weights = np.exp(-0.5 * ((logs[:, None] - logs[None, :]) / tau) ** 2)
        mixed = flat @ (weights / weights.sum(axis=1, keepdims=True)).T
        found.append(top + np.log(np.maximum(mixed, np.exp(LOWEST))))
    return np.stack(found, axis=1)


def _log_prior(number: int) -> FloatArray:
    """Of scatter (half Cauchy, by the width of its cells) and size (even, on a logarithmic axis)."""
    edges = np.r_[0.0, 0.5 * (SCATTER[1:] + SCATTER[:-1]), SCATTER[-1]]
    cells = np.diff(np.arctan(edges / TYPICAL_SCATTER))
    return np.asarray((np.log(cells / cells.sum()) - np.log(number))[:, None])
