"""``identify``: one call from a record to a Hammerstein model with uncertainty."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.identify.actuators.choice import choose_kind
from lostmotion.identify.actuators.every_kind import fits_of_all
from lostmotion.identify.actuators.kinds import KINDS, Sought, fit_kind, seek
from lostmotion.identify.actuators.memory_families import StictionFamily
from lostmotion.identify.actuators.polish import profile_intervals
from lostmotion.identify.actuators.slopes import with_equal_slopes
from lostmotion.identify.actuators.width_bound import width_bound
from lostmotion.identify.data import FEWEST_SAMPLES, IdentificationData, collect
from lostmotion.identify.evidence import SIZE, decide, weigh
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.misfit import residual_tests
from lostmotion.identify.likelihood.offset import settle_offset
from lostmotion.identify.likelihood.parameters import Scaling, name_parameters, with_profiled
from lostmotion.identify.likelihood.search import Fitted, ScaledData
from lostmotion.kernels.threads import one_thread
from lostmotion.models import (
    Backlash,
    DeadZone,
    Hammerstein,
    Identity,
    LinearModel,
    NoiseModel,
    Nonlinearity,
    Saturation,
    Stiction,
)
from lostmotion.records import LoopRecord, Prepared

DEFAULT_ORDERS = (3, 2, 1)


@one_thread
def identify(
    u: npt.ArrayLike | LoopRecord | Prepared | Sequence[LoopRecord | Prepared],
    y: npt.ArrayLike | None = None,
    dt: float | None = None,
    *,
    nonlinearity: str = "dead zone",
    orders: str | tuple[int, int, int] = "auto",
    noise: str | int = "auto",
    gain: float | None = None,
    offset: str = "auto",
    raw: bool = False,
) -> HammersteinFit:
    """Identify a Hammerstein model from commands and measurements, in open or closed loop.

    The actuator is found by a global search over high-order ARX models, the whole model is then refined by
    maximum likelihood with an autoregressive noise model. No start values are needed.

    Parameters
    ----------
    u : array_like (n,), LoopRecord, Prepared or a list of these
        Command to the actuator (OP), or the record(s) of a loop. A list is fitted as one data set, each piece
        with its own initial state. Records are prepared first (:func:`lostmotion.records.prepare`): what cannot be
        used is left out, and the report says so.
    y : array_like (n,), optional
        Measurement (PV), with arrays only.
    dt : float, optional
        Sampling time in seconds, required with arrays.
    nonlinearity : {"dead zone", "backlash", "stiction", "saturation", "none", "auto"}
        Kind of actuator. "auto" fits all and returns the one that predicts best what it was not fitted to, or the
        linear model; `fit.kinds` says how sure that is.
    orders : "auto" or (na, nb, delay)
        Orders of the linear part, ``B`` having nb + 1 coefficients; delay in samples. "auto" tries orders 1 to 3
        and delays from 1.
    noise : "auto", "white" or int
        Order of the AR noise at the output; "white" is the Output Error model of the paper.
    gain : float, optional
        Known static gain of the linear part, in units of y per unit of x (paper, eq 25). None: right_slope = 1
        and the product stays in the linear part. Only a dead zone has slopes; other kinds ignore it.
    offset : {"auto", "free", "zero"}
        Output at rest inside the dead zone. "zero" for records in deviations (the paper's model), "free" for
        absolute units; "auto" takes zero where a free offset explains nothing (information criterion), but never
        for records from which a mean was subtracted.
    raw : bool
        Take records as they are; missing samples and gaps are then refused. Arrays always are taken so.

    Returns
    -------
    HammersteinFit
        With `status`: look at it before the numbers.

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
    >>> fit = lm.identify(u, y, dt=0.1, orders=(3, 2, 3), gain=tank.linear.gain)
    >>> fit.status.name, [round(fit.parameters[name], 1) for name in ("left", "right", "right_slope")]
    ('OK', [-1.0, 1.0, 3.0])
    """
    _check_choice("nonlinearity", nonlinearity, (*KINDS, "auto"))
    orders_given = _orders(orders)
    noise_given = _noise(noise)
    if gain is not None:
        gain = finite("gain", gain)
        if gain == 0:
            raise ParameterError.expected("a gain other than 0", gain, "give y per x at rest, or leave it out")
    _check_choice("offset", offset, ("auto", "free", "zero"))
    data = collect(u, y, dt, raw, max(FEWEST_SAMPLES, _needed(orders_given, noise_given)))
    _check_length(data, orders_given, noise_given)
    settings: dict[str, Any] = {
        "nonlinearity": nonlinearity,
        "orders": list(orders_given) if orders_given else "auto",
        "noise": noise,
        "gain": gain,
        "offset": offset,
    }
    scaling = Scaling(data.u_centre, data.u_scale, data.y_centre, data.y_scale)
    scaled = ScaledData(
        (data.u - scaling.u_centre) / scaling.u_scale,
        (data.y - scaling.y_centre) / scaling.y_scale,
        data.segments,
    )
    linear = fit_kind(None, scaled, orders_given, noise_given, levels=gain is None)
    linear_result = _package(data, scaled, scaling, linear, linear, settings, gain=None)
    if nonlinearity == "none":
        return linear_result

    def result(kind: str, found: Fitted) -> HammersteinFit:
        own = gain if kind == "dead zone" else None
        packed = _package(data, scaled, scaling, found, linear, settings, own)
        return replace(packed, linear_alternative=linear_result)

    def fitted(on: ScaledData, kind: str, sought: Sought, near: Fitted | None = None) -> Fitted:
        found = fit_kind(sought, on, orders_given, noise_given, gain is None, near)
        return settle_offset(found, scaling, offset) if kind == "dead zone" else found

    if nonlinearity != "auto":
        return result(nonlinearity, fitted(scaled, nonlinearity, seek(nonlinearity, scaled, orders_given)))
    plain, linear, fits = linear, *fits_of_all(scaled, linear, orders_given, noise_given, gain is None, fitted)
    if linear is not plain:
        linear_result = _package(data, scaled, scaling, linear, linear, settings, gain=None)
    simplest = {kind: with_equal_slopes(found) for kind, found in fits.items()}
    kinds = choose_kind(scaled, {"none": linear, **simplest})
    if kinds.best == "none":
        return replace(linear_result, kinds=kinds)
    chosen = replace(result(kinds.best, fits[kinds.best]), kinds=kinds)
    if chosen.status in (Status.NOT_SEEN, Status.CANNOT_TELL):
        return replace(linear_result, kinds=kinds)
    return chosen


def _package(
    data: IdentificationData,
    scaled: ScaledData,
    scaling: Scaling,
    fitted: Fitted,
    linear: Fitted,
    settings: dict[str, Any],
    gain: float | None,
) -> HammersteinFit:
    """Result in engineering units with status."""
    named = name_parameters(fitted, scaling, gain)
    profiled = _profiled(fitted, scaling)
    covariance = with_profiled(named, profiled)
    model = _model(named.values, fitted, data.dt, data.y_centre)
    simulated, errors = fitted.problem.predict(fitted.fit.theta)
    s = fitted.problem.structure
    d = fitted.fit.theta[fitted.problem.noise_at : fitted.problem.initial_at]
    evidence = weigh(scaled, fitted, linear, named.values, data, _noise(settings["noise"]))
    tests = residual_tests(fitted, errors)
    status = decide(fitted, evidence, tests.coloured, tests.misfit, named.values, covariance)
    loads = fitted.problem.family.loads
    widest = None
    if status is Status.NOT_SEEN:
        widest = _widest(fitted, profiled, scaling)
    return HammersteinFit(
        status=status,
        model=model,
        noise=NoiseModel(tuple(d), fitted.variance * scaling.y_scale**2),
        parameters=named.values,
        covariance=covariance,
        residuals=np.concatenate(errors) * scaling.y_scale,
        simulated=_on_rows(simulated, scaled.segments, s.first, data.y.size, scaling),
        fit_percent=_fit_percent(scaled, simulated, s.first),
        tests=tests,
        evidence=evidence,
        widest=widest,
        profiled=profiled,
        settings={
            **settings,
            "chosen": {
                "na": s.na,
                "nb": s.nb,
                "delay": s.delay,
                "noise_order": s.noise_order,
                "integrating": s.integrating,
                "loads": [event.to_dict() for event in loads.events] if loads is not None else [],
            },
            "offset_fixed": fitted.basis is not None,
        },
        data=data,
    )


def _profiled(fitted: Fitted, scaling: Scaling) -> dict[str, tuple[float, float]]:
    """Profile intervals in units of OP, where the likelihood has jumps."""
    if not fitted.problem.family.kinks:
        return {}
    size = scaling.u_scale
    return {name: (size * low, size * high) for name, (low, high) in profile_intervals(fitted).items()}


def _widest(fitted: Fitted, profiled: dict[str, tuple[float, float]], scaling: Scaling) -> float | None:
    """Largest width or band that the record does not exclude."""
    kind = fitted.problem.family.kind
    if kind == "dead zone":
        return width_bound(fitted) * scaling.u_scale
    return profiled[SIZE[kind]][1] if kind in SIZE else None


def _model(values: dict[str, float], fitted: Fitted, dt: float, level: float) -> Hammerstein:
    s = fitted.problem.structure
    linear = LinearModel(
        tuple(values[f"a{i + 1}"] for i in range(s.na)),
        tuple(values[f"b{i}"] for i in range(s.nb + 1)),
        s.delay,
        dt,
    )
    return Hammerstein(_actuator(values, fitted.problem.family), linear, values.get("offset", level))


def _actuator(values: dict[str, float], family: Family) -> Nonlinearity:
    if family.kind == "dead zone":
        left = min(values["left"], values["right"])
        return DeadZone(left, values["right"], values["left_slope"], values["right_slope"])
    if family.kind == "backlash":
        return Backlash(values["width"])
    if isinstance(family, StictionFamily):
        return Stiction(values["band"], values["jump"], family.model)
    if family.kind == "saturation":
        return Saturation(values["low"], values["high"])
    return Identity()


def _on_rows(
    simulated: list[FloatArray], segments: npt.NDArray[np.int64], first: int, n: int, scaling: Scaling
) -> FloatArray:
    """Simulated output in engineering units on the rows of the data; NaN before the first simulated row."""
    rows = np.full(n, np.nan)
    for (start, stop), z in zip(segments, simulated, strict=True):
        rows[start + first : stop] = scaling.y_centre + scaling.y_scale * z
    return rows


def _fit_percent(data: ScaledData, simulated: list[FloatArray], first: int) -> float:
    y = np.concatenate([data.y[start + first : stop] for start, stop in data.segments])
    miss = y - np.concatenate(simulated)
    return float(100.0 * (1.0 - np.linalg.norm(miss) / max(float(np.linalg.norm(y - y.mean())), 1e-300)))


def _check_choice(name: str, value: object, allowed: tuple[str, ...]) -> None:
    if value not in allowed:
        raise ParameterError.expected(f"{name} as one of {list(allowed)}", repr(value), "see the docstring")


def _orders(orders: str | tuple[int, int, int]) -> tuple[int, int, int] | None:
    if isinstance(orders, str):
        _check_choice("orders", orders, ("auto",))
        return None
    remedy = "whole numbers >= 0, e.g. (3, 2, 3)"
    try:
        na, nb, delay = (whole("orders", value, 0) for value in orders)
    except (TypeError, ValueError) as error:
        raise ParameterError.expected("orders as (na, nb, delay)", repr(orders), remedy) from error
    return na, nb, delay


def _noise(noise: str | int) -> int | None:
    if isinstance(noise, str):
        _check_choice("noise", noise, ("auto", "white"))
        return 0 if noise == "white" else None
    if isinstance(noise, bool):
        raise ParameterError.expected('noise as "auto", "white" or an order', noise, "e.g. noise=4")
    return whole('noise (or "auto", "white")', noise, 0)


def _needed(orders: tuple[int, int, int] | None, noise: int | None) -> int:
    """Samples that every segment must have."""
    return 3 * (sum(orders or DEFAULT_ORDERS) + (noise or 0)) + 30


def _check_length(data: IdentificationData, orders: tuple[int, int, int] | None, noise: int | None) -> None:
    needed = _needed(orders, noise)
    na, nb, delay = orders or DEFAULT_ORDERS
    if data.shortest < needed:
        raise DataError.expected(
            f"at least {needed} samples in every segment for orders {(na, nb, delay)}",
            f"{data.shortest}",
            "use lower orders or longer records",
        )
