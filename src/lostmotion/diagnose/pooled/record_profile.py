"""The likelihood of every kind of lost motion over its size, in one record: what pooling adds up."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.drawn_rows import drawn_share, of_a_historian, size_hidden_in
from lostmotion.diagnose.excitation import moved_freely, only_fed_back
from lostmotion.diagnose.features import swing_of_rows
from lostmotion.diagnose.pooled.size_curve import NORMAL, SizeCurve
from lostmotion.errors import DataError
from lostmotion.identify.actuators.choice import likelihood_gain
from lostmotion.identify.actuators.every_kind import EveryKind
from lostmotion.identify.actuators.fit_kind import fit_kind, fit_linear
from lostmotion.identify.actuators.held_size import HeldSize
from lostmotion.identify.actuators.kind import NEEDED, Kind, faults, kind_of
from lostmotion.identify.actuators.loads import without_loads
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.data import collect
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import SMALLEST, cost_of_parameters
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.parameters import name_parameters, with_profiled
from lostmotion.identify.likelihood.problem import Structure
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.identify.unseen_moves import Unseen
from lostmotion.kernels.threads import one_thread
from lostmotion.records import Prepared

REFINED = 3  # forms of a held size: the best before the refinement
RESTS = np.linspace(-1.0, 1.0, 9).tolist()  # of half the band, where a valve may begin
ALWAYS = -1.0  # a sum of squares that is never reached: every held size is refined
SMALLEST_SHARE = 0.01  # of the range of OP: smaller sizes do as a linear process does
NOTHING = Unseen()
WORTH = 1.0  # of log-likelihood: a maximum below it gets no interval, which takes long


@dataclass(frozen=True)
class _Models:
    """Fits of one record, from which sizes are held.

    `beside` are linear processes of other structures: of the valve's other records. Where the loop has settled between
    the rows, a valve that sticks looks like a sound one, and none is told.
    """

    linear: Fitted
    fits: dict[str, Fitted]
    scaled: ScaledData
    beside: tuple[Fitted, ...] = ()
    settled: bool = False

    @cached_property
    def bases(self) -> list[Fitted]:
        """Processes with noise and loads beside which a size is held; loads may stand for what the valve does."""
        bare = [] if self.linear.problem.family.loads is None else [without_loads(self.linear)]
        return [self.linear, *bare, *self.fits.values(), *self.beside]

    def like(self, other: Structure) -> _Models:
        """With a linear process of this structure, whose noise is found anew."""
        asked = Asked((other.na, other.nb, other.delay), None, other.integrating)
        if self.scaled.shortest < asked.needed:
            return self
        return replace(self, beside=(fit_linear(self.scaled, asked),))

    @property
    def linear_gain(self) -> float:
        """What the best of the processes beside gains over the linear one: a fault must beat that too."""
        return max([0.0, *(_gain_of(one, self.linear, one.fit.cost) for one in self.beside)])

    def gains(self, kind: Kind, sizes: FloatArray) -> FloatArray:
        """Over the linear processes at held sizes (units of OP)."""
        if self.settled and kind.sticks:
            return np.zeros(len(sizes))
        found = self.fits.get(kind.name)
        share = 1.0 if found is None else _firm_share(found, self.linear)
        scale = self.scaled.scaling.u_scale
        gains = share * np.array([_gain(self.linear, self.bases, kind, size / scale) for size in sizes])
        return gains - self.linear_gain

    def gain_at(self, kind: Kind, own: FloatArray) -> float:
        """Over the linear process with the places of a kind held (units of OP), beyond its cost; 0 where OP meets none.

        As for sizes, gains and losses below the cost tell nothing.
        """
        scaling = self.scaled.scaling
        (family,) = kind.forms(self.scaled)
        held = family.valid((own - scaling.u_centre) / scaling.u_scale)
        if not kind.meets(held, self.linear.problem.u):
            return 0.0
        found, cost = self.fits.get(kind.name), _cost(kind, self.linear.problem.errors)
        forms = [(base, HeldSize.on(base, kind, family, held)) for base in self.bases]
        gross = max(_gain_of(base, self.linear, form.refined(ALWAYS)) for base, form in forms)
        share = 1.0 if found is None else _firm_share(found, self.linear)
        return float(share * np.sign(gross) * max(abs(gross) - cost, 0.0))

    def curve(self, kind: Kind, sizes: FloatArray) -> SizeCurve:
        """Over held sizes, and about the maximum where the kind was found."""
        gains, found = self.gains(kind, sizes), self.fits.get(kind.name)
        plain = SizeCurve(sizes, gains, cost=_cost(kind, self.linear.problem.errors))
        if found is None or not kind.met(found) or (self.settled and kind.sticks):
            return plain
        top = _firm_share(found, self.linear) * _gain_of(found, self.linear, found.fit.cost)
        if top < WORTH:
            return plain
        size, interval = _size(kind, found, self.scaled.scaling)
        return replace(plain, size=size, gain=top, interval=interval)


@dataclass(frozen=True)
class RecordProfile:
    """What one record says of every kind.

    Attributes
    ----------
    curves : dict of SizeCurve
        Of every kind that has a size.
    gains : dict of float
        Gain in log-likelihood of every kind that was found over the linear process, less what its own parameters cost
        and less what rests on a few rows.
    op_range : float
        Of the rows used, in units of OP.
    rows : int
        Used.
    fed_back : bool
        Whether nothing but PV moves OP, or PV answers nothing else that does: such a record excludes no size.
    unseen : Unseen
        What OP does between the rows.
    hides_size : str
        Why it tells no size of a valve that sticks; empty where it does.
    swing : float
        Of OP from end to end, where it swings regularly; else 0.
    """

    curves: dict[str, SizeCurve]
    gains: dict[str, float]
    op_range: float
    rows: int
    _models: _Models = field(repr=False)
    fed_back: bool = False
    unseen: Unseen = NOTHING
    hides_size: str = ""
    swing: float = 0.0

    def place(self, name: str) -> FloatArray | None:
        """Own parameters of a kind in units of OP where it gains in this record; None where it does not."""
        found = self._models.fits.get(name) if self.gains.get(name, 0.0) > 0.0 else None
        if found is None or not kind_of(name).met(found):
            return None
        scaling, own = self._models.scaled.scaling, kind_of(name).places_met(found.actuator, found.problem.u)
        return np.asarray(scaling.u_centre + scaling.u_scale * own)

    def placed(self, name: str, own: FloatArray) -> RecordProfile:
        """With the gain of a kind at these parameters (units of OP) in the place of that at its own."""
        return replace(self, gains={**self.gains, name: self._models.gain_at(kind_of(name), own)})

    def structure(self, name: str) -> Structure | None:
        """Of the process beside a kind; None where it was not found."""
        found = self._models.fits.get(name)
        return None if found is None else found.problem.structure

    def finer(self, name: str, sizes: FloatArray, like: Structure | None = None) -> RecordProfile:
        """With further held sizes of one kind, where OP goes that far, also beside a process of another structure.

        In a record that shows little of the process, its delay or orders are often wrong, and a valve that is there
        then fits worse than none.
        """
        curve = self.curves[name]
        more = sizes[sizes <= self.op_range]
        models = self._models if like is None else self._models.like(like)
        gains = models.gains(kind_of(name), more)
        order = np.argsort(np.r_[curve.sizes, more])
        finer = replace(curve, sizes=np.r_[curve.sizes, more][order], gains=np.r_[curve.gains, gains][order])
        return replace(self, curves={**self.curves, name: finer})


@one_thread
def profile_record(prepared: Prepared, sizes: FloatArray, integrating: bool | None = None) -> RecordProfile:
    """Fit every kind, then hold each at the sizes (in units of OP, ascending).

    Raises
    ------
    DataError
        The record is refused, or most of its rows were never measured.
    """
    asked = Asked(integrating=integrating)
    data = collect(prepared, None, None, False, asked.needed)
    if share := drawn_share(data):
        raise DataError(of_a_historian(share))
    scaled = ScaledData.of(data, Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale))
    linear, fits = _every_fit(scaled, asked)
    models, span = _Models(linear, fits, scaled, settled=data.unseen.settled), float(np.ptp(data.u))
    held = sizes[(sizes >= SMALLEST_SHARE * span) & (sizes <= span)]
    curves = {kind.name: models.curve(kind, held) for kind in faults() if kind.size is not None}
    gains = {name: likelihood_gain(kind_of(name).simplest(found), linear)[1] for name, found in fits.items()}
    gains = {name: kind_of(name).handicapped(gains, fits) for name in gains}
    loop = feedback(scaled)
    gain = -float(loop.direction) or float(linear.parts.b.sum())
    foreknown = data.unseen.mostly or data.foretold.against(gain)
    fed_back = only_fed_back(loop.closed, moved_freely(data, loop.free), data.sp) or (
        loop.closed and (foreknown or not data.answered)
    )
    unseen = data.unseen if loop.closed else replace(data.unseen, possible=0.0)
    own = (unseen, size_hidden_in(data, loop.closed, sticks=True), swing_of_rows(data))
    return RecordProfile(curves, gains, span, data.u.size, models, fed_back, *own)


def _every_fit(scaled: ScaledData, asked: Asked) -> tuple[Fitted, dict[str, Fitted]]:
    """Linear process and likely kinds, as ``identify`` fits them."""
    alone = fit_linear(scaled, asked)

    def fit(data: ScaledData, kind: Kind, sought: Sought, near: Fitted | None) -> Fitted:
        found = fit_kind(sought, data, asked, near, alone if near is None else None)
        return kind.settled(found, data.scaling, "auto")

    return EveryKind(scaled, asked, fit).fits(alone)


def _cost(kind: Kind, rows: int) -> float:
    """What a kind costs in every record, its size too: as if the record were alone (BIC, and its search).

    Paid for once, the small gains that a play has over drift in records of sound valves added up to a certainty.
    """
    return float(0.5 * len(kind.family.own) * np.log(rows) + max(kind.searched, NEEDED))


def _gain(linear: Fitted, bases: list[Fitted], kind: Kind, size: float) -> float:
    """Of the best form of a size, everything else refined."""
    trials = [(_gain_of(base, linear, form.cost), base, form) for base in bases for form in _forms(base, kind, size)]
    trials.sort(key=lambda trial: -trial[0])
    return max(_gain_of(base, linear, form.refined(ALWAYS)) for _, base, form in trials[:REFINED])


def _forms(base: Fitted, kind: Kind, size: float) -> Iterator[HeldSize]:
    """Models of this size, a valve with a memory beginning at places all over its band."""
    for family, own in kind.of_size(base.problem, size):
        if not family.resting:
            yield HeldSize.on(base, kind, family, own)
        elif family.rests[0] == 0.0:  # those of `of_size` are too few for the likelihood of one turn
            for rest in RESTS:
                yield HeldSize.on(base, kind, family.with_rests([rest] * family.resting), own)


def _gain_of(base: Fitted, linear: Fitted, cost: float) -> float:
    """In log-likelihood over the linear process for a sum of squares; a structure of its own is paid for (BIC).

    The parameters of the actuator are paid for by ``_cost``.
    """
    n = base.problem.errors
    own = len(base.problem.family.own) * float(np.log(n))
    paid = cost_of_parameters(base, n) - own - cost_of_parameters(linear, n)
    beside = linear.fit.cost / linear.problem.errors
    return float(0.5 * (n * np.log(beside * n / max(cost, SMALLEST)) - paid))


def _firm_share(found: Fitted, linear: Fitted) -> float:
    """Share of a gain that does not rest on a few rows."""
    cost = 0.5 * (cost_of_parameters(found, found.problem.errors) - cost_of_parameters(linear, linear.problem.errors))
    total, firm = (gain + cost for gain in likelihood_gain(found, linear))
    return float(np.clip(firm / total, 0.0, 1.0)) if total > 0.0 else 1.0


def _size(kind: Kind, found: Fitted, scaling: Scaling) -> tuple[float, tuple[float, float]]:
    """Size with its 95 % interval, by profile or by curvature as the kind has it."""
    named = name_parameters(found, scaling, None)
    profiled = kind.intervals(found, scaling)
    name = str(kind.size)
    size = float(named.values[name])
    if name in profiled:
        return size, profiled[name]
    at = list(named.values).index(name)
    reach = NORMAL * float(np.sqrt(max(with_profiled(named, profiled)[at, at], 0.0)))
    return size, (size - reach, size + reach)
