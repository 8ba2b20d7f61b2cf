"""``identify``: one call from a record to a Hammerstein model with uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite
from lostmotion.errors import ParameterError, Status
from lostmotion.identify.actuators.asked_kind import AskedKind
from lostmotion.identify.actuators.break_away import broken_away
from lostmotion.identify.actuators.choice import choose_kind, likelihood_gain, set_aside
from lostmotion.identify.actuators.every_kind import EveryKind, further
from lostmotion.identify.actuators.fit_kind import fit_kind, fit_linear
from lostmotion.identify.actuators.free_simulation import another_size, simulated
from lostmotion.identify.actuators.kind import NO_FAULT, Kind, kind_names, kind_of
from lostmotion.identify.actuators.level import as_level
from lostmotion.identify.actuators.loads import without_actuator
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.call import Call
from lostmotion.identify.data import FEWEST_SAMPLES, collect
from lostmotion.identify.earned import CLAIMS, FEWEST_REVERSALS, reversals
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.left_open import left_open, may_be_denied, surely_ahead, untold, with_found
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.criterion import gain_over_linear
from lostmotion.identify.likelihood.feedback import feedback
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.identify.recording import Recording
from lostmotion.identify.scaled import ScaledData
from lostmotion.identify.seen_position import beside_position
from lostmotion.identify.settings import check_choice, check_length, integrating_of, noise_lags_of, orders_of
from lostmotion.identify.status import VAGUE, excluded_sizes
from lostmotion.kernels.threads import one_thread
from lostmotion.records import LoopRecord, Prepared, RecordLike
from lostmotion.records.as_record import Column, as_records
from lostmotion.records.loop_type import surely_integrates

ENDLESS = (Status.NO_PROCESS, Status.NOT_CONVERGED)
AS_LIKELY = 5.0  # of log-likelihood by which an integrating process may be behind one that does not settle
MOST_OPEN = 0.1  # of the range of OP: a level that leaves larger sizes open does not show that there is none
FLOW = "The process was taken as self-regulating, as this loop is one of flow; say so where it integrates."


@one_thread
def identify(
    u: npt.ArrayLike | RecordLike | Prepared | Sequence[RecordLike | Prepared],
    y: npt.ArrayLike | None = None,
    dt: float | None = None,
    *,
    nonlinearity: str = "auto",
    orders: str | tuple[int, int, int] = "auto",
    noise: str | int = "auto",
    gain: float | None = None,
    offset: str = "auto",
    raw: bool = False,
    integrating: bool | None = None,
    op: str | None = None,
    pv: str | None = None,
    sp: Column = None,
    time: Column = None,
) -> HammersteinFit:
    """Identify a Hammerstein model from commands and measurements, in open or closed loop.

    The actuator is found by a global search over high-order ARX models, the whole model is then refined by
    maximum likelihood with coloured noise. No start values are needed.

    Parameters
    ----------
    u : array_like (n,), LoopRecord, Prepared, path, data frame, dict of columns or a list of these
        Command to the actuator (OP), or the record(s) of a loop; what is none yet is read by ``read_loop``. A list
        is fitted as one data set, each piece with its own initial state. Records are prepared first
        (:func:`lostmotion.records.prepare`): what cannot be used is left out, and the report says so.
    y : array_like (n,), optional
        Measurement (PV), with arrays only.
    dt : float, optional
        Sampling time in seconds, required with arrays, and with a table that has no times.
    nonlinearity : {"auto", "dead zone", "backlash", "stiction", "saturation", "none"}
        Kind of actuator. "auto" fits all and returns the one that predicts best what it was not fitted to, or the
        linear model; `fit.kinds` says how sure that is. A kind that is named is fitted alone, which takes less time,
        and compared with the others: where one of them is likelier, the status is OTHER_KIND.
    orders : "auto" or (na, nb, delay)
        Orders of the linear part, ``B`` having nb + 1 coefficients; delay in samples. "auto" tries orders 1 to 3
        and delays from 1.
    noise : "auto", "ar", "white" or int
        Noise at the output: "auto" chooses the order of an autoregression and a zero, which slow drift behind fast
        noise has (docs/method.md); "ar" and a number have none; "white" is the Output Error model of the paper.
    gain : float, optional
        Known static gain of the linear part, in units of y per unit of x (paper, eq 25). None: right_slope = 1
        and the product stays in the linear part. Only a dead zone has slopes; other kinds ignore it.
    offset : {"auto", "free", "zero"}
        Output at rest inside the dead zone. "zero" for records in deviations (the paper's model), "free" for
        absolute units; "auto" takes zero where a free offset explains nothing (information criterion), but never
        for records from which a mean was subtracted.
    raw : bool
        Take records as they are; missing samples and gaps are then refused. Arrays always are taken so.
    integrating : bool, optional
        Whether the process integrates (a level), where that is known. None: chosen from the data; with a known gain, or
        where the records are of a flow, it does not.
    op, pv, sp, time : optional
        Columns of a path, a frame or a dict where they have other names, as in :func:`lostmotion.read_loop`.

    Returns
    -------
    HammersteinFit
        With `status`: look at it before the numbers. Where the record has the actuator's position, what that shows
        is in `actuator`; a fault that PV does not show is then more likely (OTHER_KIND).

    Raises
    ------
    DataError
        Missing, infinite or constant data, lengths that differ, too few samples for the orders.
    ParameterError
        Unknown settings, or a gain that contradicts the record.

    Notes
    -----
    The likelihood is conditional on the first `delay + noise order` samples of each segment; initial states are
    estimated. Intervals are from the Fisher information at the optimum. Method: Ljung, *System Identification*,
    2nd ed., chapters 7 and 10; key idea of the profile in the module ``identify.profile``.

    Examples
    --------
    >>> import numpy as np, lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> u = lm.signals.prs(2000, -5, 5, hold=10, seed=1)
    >>> y = tank.simulate(u) + np.random.default_rng(1).normal(scale=0.03**0.5, size=2000)
    >>> fit = lm.identify(u, y, dt=0.1, nonlinearity="dead zone", orders=(3, 2, 3), gain=tank.linear.gain)
    >>> fit.status.name, [round(fit.parameters[name], 1) for name in ("left", "right", "right_slope")]
    ('OK', [-1.0, 1.0, 3.0])
    """
    if y is None or any(name is not None for name in (op, pv, sp, time)):
        u = as_records(u, op=op, pv=pv, sp=sp, time=time, dt=dt)
    found = _or_integrating(_asked_for(u, y, dt, nonlinearity, orders, noise, gain, offset, raw, integrating))
    return beside_position(replace(found, status=Status.CANNOT_TELL) if untold(found) else found, u)


@one_thread
def identify_for_verdict(
    record: Prepared, integrating: bool | None, sound: float, recording: Recording | None = None
) -> HammersteinFit:
    """All kinds; sizes are excluded as well where the fault that was found may be denied.

    That is where it is no larger than a sound valve has, `sound` in units of OP, or its gain is small. `recording` is
    what more rows than these tell of how they were recorded.
    """
    asked_for = _asked_for(record, None, None, "auto", "auto", "auto", None, "auto", False, integrating)
    data = replace(asked_for.data, recording=recording)
    return _or_integrating(replace(asked_for, data=data, sound=sound))


@one_thread
def identify_alone(
    records: Sequence[LoopRecord], nonlinearity: str, orders: tuple[int, int, int], noise: str | int, offset: str
) -> HammersteinFit:
    """A kind without a look at the others, from records as they are: for estimators that follow this kind."""
    noise = "ar" if noise == "auto" else noise  # recursions know no zero
    asked_for = _asked_for(records, None, None, nonlinearity, orders, noise, None, offset, True, None)
    return replace(asked_for, compared=False).run()


def _or_integrating(asked_for: _Identification) -> HammersteinFit:
    """The fit; where it ends at no process that settles within the record, an integrating one, if that is as likely.

    A level that is held by a controller shows little of a slow pole, and the fit of one does not end.
    """
    found, asked = asked_for.run(), asked_for.asked
    if found.status not in ENDLESS or asked.integrating is not None or asked.orders is not None:
        return found
    other = replace(asked_for, asked=replace(asked, integrating=True)).run()
    behind = 0.5 * other.residuals.size * np.log(other.noise.variance / max(found.noise.variance, 1e-300))
    return other if other.status in CLAIMS and behind < AS_LIKELY else found


def _asked_for(
    u: Any,
    y: npt.ArrayLike | None,
    dt: float | None,
    nonlinearity: str,
    orders: str | tuple[int, int, int],
    noise: str | int,
    gain: float | None,
    offset: str,
    raw: bool,
    integrating: bool | None,
) -> _Identification:
    """What was handed to ``identify``, checked."""
    check_choice("nonlinearity", nonlinearity, (*kind_names(), "auto"))
    asked = Asked(
        orders_of(orders), noise_lags_of(noise), integrating_of(integrating, orders, gain), noise == "auto"
    )  # fmt: skip
    if gain is not None:
        gain = finite("gain", gain)
        if gain == 0:
            raise ParameterError.expected("a gain other than 0", gain, "give y per x at rest, or leave it out")
    check_choice("offset", offset, ("auto", "free", "zero"))
    data = collect(u, y, dt, raw, max(FEWEST_SAMPLES, asked.needed))
    if asked.integrating is None and (known := _known_to_integrate(u)) is not None:
        asked, data = replace(asked, integrating=known), replace(data, notes=(*data.notes, FLOW))
    check_length(data.shortest, asked)
    settings: dict[str, Any] = {
        "nonlinearity": nonlinearity,
        "orders": list(asked.orders) if asked.orders else "auto",
        "noise": noise,
        "gain": gain,
        "offset": offset,
        "integrating": integrating,
    }
    return _Identification(data, asked, settings)


def _known_to_integrate(u: object) -> bool | None:
    """What the type of the loop says; records of one loop have one type."""
    records = u if isinstance(u, Sequence) else [u]
    loops = [one.record if isinstance(one, Prepared) else one for one in records]
    types = {one.loop_type for one in loops if isinstance(one, LoopRecord) and one.loop_type}
    return surely_integrates(types.pop()) if len(types) == 1 else None


class _Identification(Call):
    """One call of ``identify``: the search over kinds, and what it says of them."""

    def run(self) -> HammersteinFit:
        """Fit what was asked for, beside the linear model."""
        name, linear = self.settings["nonlinearity"], fit_linear(self.scaled, self.asked)
        if name == "auto":
            return self._likeliest(linear)
        if name == NO_FAULT:
            return self.packed(linear, linear)
        kind = kind_of(name)
        found = self._fitted(linear, self.scaled, kind, kind.sought(self.scaled, self.asked))
        found = broken_away(self._beside_nested(kind, found, linear))
        plain, linear = linear, max(linear, without_actuator(found), key=lambda one: gain_over_linear(one, linear))
        packed = self.packed(found, linear)
        otherwise = None
        if self.compared:
            otherwise = self._as_level(plain, found, name) or self._by_simulation(packed, linear, {name: found})
        packed = otherwise or self._compared(packed, found, linear)
        if packed.status not in HIDDEN:
            return packed
        return replace(packed, linear_alternative=self.packed(linear, linear))

    def _compared(self, packed: HammersteinFit, found: Fitted, linear: Fitted) -> HammersteinFit:
        """The result of the kind asked for, with another status where another kind is likelier."""
        if not self.compared or packed.status in (Status.SAME_SIGNAL, Status.CANNOT_TELL):
            return packed
        other = AskedKind(self.scaled, self.asked, partial(self._fitted, linear)).likelier(found, linear)
        if other is None:
            return packed
        evidence = replace(packed.evidence, other_kind=other)
        return replace(packed, status=Status.OTHER_KIND, evidence=evidence, widest=None)

    def _beside_nested(self, kind: Kind, found: Fitted, linear: Fitted) -> Fitted:
        """The kind also begun at the one that it nests, where that is seen as well: as beside all other kinds."""
        if not kind.nests:
            return found
        inner = kind_of(kind.nests)
        nested = self._fitted(linear, self.scaled, inner, inner.sought(self.scaled, self.asked), found)
        fits = {kind.name: found, inner.name: nested}
        further(fits, kind, linear, self.asked)
        return fits[kind.name]

    def _fitted(
        self, linear: Fitted, scaled: ScaledData, kind: Kind, sought: Sought, near: Fitted | None = None
    ) -> Fitted:
        """Near another fit, or at processes of its own and beside the linear model."""
        found = fit_kind(sought, scaled, self.asked, near, linear if near is None else None)
        return kind.settled(found, scaled.scaling, self.settings["offset"])

    def _likeliest(self, linear: Fitted) -> HammersteinFit:
        """The kind that predicts best, or the linear model where none is seen; by simulation where that differs."""
        plain = linear
        linear, fits = EveryKind(self.scaled, self.asked, partial(self._fitted, linear)).fits(linear)
        found = self._by_prediction(linear, fits)
        level = self._as_level(plain, fits.get(found.kind.name, linear))
        return level or self._by_simulation(found, linear, fits) or found

    def _as_level(self, linear: Fitted, found: Fitted, name: str | None = None) -> HammersteinFit | None:
        """A level under control whose load drifts, where that is likelier than what was found; `name` is asked for."""
        other = as_level(self.scaled, self.asked, linear, name)
        if other is None or likelihood_gain(other.chosen, found)[0] <= 0.0:
            return None
        packed = self.packed(other.chosen, other.none, interval=other.interval, answered=other.answered)
        kinds = replace(other.kinds, excluded=excluded_sizes(other.kinds.excluded, self.data, self.scaled.scaling))
        if name is not None:
            ahead = kinds.ahead_of(name)
            evidence = replace(packed.evidence, other_kind=ahead)
            return (
                packed if ahead is None else replace(packed, status=Status.OTHER_KIND, evidence=evidence, widest=None)
            )
        left_open = max(size for kind, size in kinds.excluded.items() if kind_of(kind).sticks)
        if packed.preferred == NO_FAULT and left_open > MOST_OPEN * float(np.ptp(self.data.u)):
            packed = replace(packed, status=Status.CANNOT_TELL, widest=None)
        return replace(packed, kinds=kinds)

    def _by_prediction(self, linear: Fitted, fits: dict[str, Fitted]) -> HammersteinFit:
        simplest = {name: kind_of(name).simplest(found) for name, found in fits.items()}
        kinds = choose_kind(self.scaled, {NO_FAULT: linear, **simplest})
        aside = set_aside(kinds, simplest, linear)
        if kinds.best != NO_FAULT:
            chosen = self.packed(fits[kinds.best], linear)
            if chosen.status not in (Status.NOT_SEEN, Status.CANNOT_TELL):
                if self.sound is not None and may_be_denied(chosen, kinds, self.sound):
                    beside = self.packed(linear, linear)
                    sizes = left_open(linear, fits, beside, self.scaled.scaling, ahead=surely_ahead(kinds))
                    kinds = replace(kinds, excluded=with_found(sizes, chosen))
                return replace(chosen, kinds=kinds)
            aside = [kinds.best]
        sized = [self.packed(fits[kind], linear) for kind in aside if kind_of(kind).size]
        # beside their own other parameters, not beside the linear model
        bounds = {fit.kind.name: fit.widest for fit in sized if fit.widest is not None}
        slow, linear_result = len(sized) < len(aside), self.packed(linear, linear)  # a slow valve is no linear one
        if linear_result.status in CLAIMS and reversals(self.data.u, self.data.segments) < FEWEST_REVERSALS:
            linear_result = replace(linear_result, status=Status.CANNOT_TELL)
        sizes = left_open(linear, fits, linear_result, self.scaled.scaling, slow)
        return replace(linear_result, kinds=replace(kinds, excluded=sizes | bounds))

    def _by_simulation(self, found: HammersteinFit, linear: Fitted, fits: dict[str, Fitted]) -> HammersteinFit | None:
        """What reproduces PV best from OP alone, where that differs from what predicts best; of the kind asked for."""
        if self.asked.noise is not None or self.data.sp is not None or feedback(self.scaled).closed:
            return None  # who records a set point has a controller
        chosen = fits.get(found.kind.name, linear)
        rival = simulated(self.scaled, self.asked, linear, chosen, fits, found.status is not Status.OK)
        if rival is None:
            return None
        asked_for = found.kinds is None
        name = rival.kinds.best if rival.clear and not asked_for else found.kind.name
        if name not in rival.fits:
            return None
        other = self.packed(rival.fits[name], rival.fits[NO_FAULT], linear)
        size = None if found.kind.size is None else found.parameters[found.kind.size]
        other = replace(other, evidence=replace(other.evidence, by_prediction=(found.kind.name, size)))
        if other.status not in CLAIMS or not (rival.clear or another_size(found, other, found.kind)):
            return None
        if asked_for and rival.clear and (ahead := rival.kinds.ahead_of(name)) is not None:
            evidence = replace(other.evidence, other_kind=ahead)
            return replace(other, status=Status.OTHER_KIND, evidence=evidence, widest=None)
        low, high = other.size_interval  # of a size that is known the place may be less so
        vague = other.status is Status.WIDE and high - low > VAGUE * other.parameters.get("width", np.inf)
        status = Status.WIDE if vague else Status.MISFIT
        return replace(other, status=status, kinds=rival.kinds if rival.clear and not asked_for else found.kinds)
