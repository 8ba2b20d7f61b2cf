"""The dictionary of a fit, read and checked field by field."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from lostmotion.arguments import LONGEST, SHORTEST
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, Status
from lostmotion.files.fields import Fields, as_list, as_number
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.actuators.kind import Kind, kind_of
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.models import Hammerstein, LinearModel, NoiseModel, Nonlinearity, actuator_from_dict
from lostmotion.records.compression import MadeUp

REMEDY = "use the JSON that was saved of a fit"
NEEDED = (
    "status", "preferred", "model", "noise", "parameters", "covariance", "intervals_95", "evidence", "settings", "data",
)  # fmt: skip


def facts_from_dict(data: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of :class:`FitFacts`.

    Files of older versions have neither ``profiled`` (then the saved intervals stand for it) nor the noise of OP, nor
    what a historian made up; where no span of OP was known, none is saved.

    Raises
    ------
    DataError
        Something is missing, of another type, or contradicts itself.
    """
    saved = Fields(data, "a fit", REMEDY)
    saved.require(*NEEDED)
    status, model = _status(saved), _model(saved.part("model"))
    kind, parameters = kind_of(model.nonlinearity.kind), _parameters(saved.part("parameters"))
    about, settings = saved.part("data"), saved.part("settings")
    _require_own(kind, parameters)
    return {
        "status": status,
        "model": model,
        "noise": _noise(saved.part("noise")),
        "parameters": parameters,
        "covariance": _covariance(saved, len(parameters)),
        "fit_percent": saved.number("fit_percent"),
        "evidence": _evidence(saved.part("evidence")),
        "widest": _widest(saved, status, kind),
        "profiled": _profiled(saved, kind),
        "kinds": _kinds(saved),
        "chosen": _chosen(settings.part("chosen")),
        "known_gain": settings.number_or_none("gain"),
        "op_range": about.pair("op_range"),
        "op_span": about.made("op_span", "a span (low, high)", _span) if "op_span" in about else None,
        "op_noise": about.number_or_none("op_noise"),
        "dt": _dt(about, model.linear),
        "samples": about.count("samples"),
        "made_up": about.made("made_up", "shares of rows made up", _made_up) if "made_up" in about else None,
        **{name: about.text(name) for name in ("tag", "source", "fingerprint")},
    }


def finite(value: float) -> float | None:
    """Number for JSON, which knows no infinity."""
    return float(value) if np.isfinite(value) else None


def _status(saved: Fields) -> Status:
    return saved.made("status", f"one of {[status.name for status in Status]}", lambda name: Status[name])


def _model(saved: Fields) -> Hammerstein:
    actuator = saved.made("nonlinearity", "an actuator that is identified", _actuator)
    linear = saved.made("linear", "a linear process that PV answers", _process)
    return Hammerstein(actuator, linear, saved.number("offset"))


def _process(data: Any) -> LinearModel:
    linear = LinearModel.from_dict(data)
    if not any(linear.b):
        raise ValueError("b is 0")
    return linear


def _dt(about: Fields, linear: LinearModel) -> float:
    """Sampling time of the record, which is that of the process and one that a record can have."""
    dt = about.number("dt")
    if not SHORTEST <= dt <= LONGEST or linear.dt != dt:
        got = f"{dt:g} s beside a process at {linear.dt:g} s"
        raise DataError.expected(f"one dt from {SHORTEST:g} to {LONGEST:g} s in a fit", got, REMEDY)
    return dt


def _actuator(data: Any) -> Nonlinearity:
    actuator = actuator_from_dict(data)
    kind_of(actuator.kind)
    return actuator


def _chosen(saved: Fields) -> Chosen:
    """Structure; older files have no loads, and noise without a zero."""
    loads = saved.made("loads", "a list of loads", _loads) if "loads" in saved else ()
    na, nb, delay, noise_order = (saved.count(name) for name in ("na", "nb", "delay", "noise_order"))
    zero = saved.number("noise_zero") if "noise_zero" in saved else 0.0
    names = ("slopes", "asymmetry", "break_away")
    slopes, asymmetry, still = (saved.made(name, "two numbers", _pair) if name in saved else None for name in names)
    intervals = "break_away_intervals"
    ranges = saved.made(intervals, "two pairs of numbers", _two_pairs) if intervals in saved else None
    integrating = saved.flag("integrating")
    return Chosen(na, nb, delay, noise_order, integrating, loads, zero, slopes, asymmetry, still, ranges)


def _pair(saved: object) -> tuple[float, float] | None:
    if saved is None:
        return None
    first, second = map(as_number, as_list(saved))
    return first, second


def _two_pairs(saved: object) -> tuple[tuple[float, float], tuple[float, float]] | None:
    pairs = None if saved is None else tuple(map(_pair, as_list(saved)))
    if pairs is None:
        return None
    first, second = pairs
    if first is None or second is None:
        raise TypeError
    return first, second


def _loads(rows: object) -> tuple[Mapping[str, float], ...]:
    return tuple(map(_load, as_list(rows)))


def _load(row: object) -> Mapping[str, float]:
    if not isinstance(row, Mapping):
        raise TypeError
    for value in row.values():
        as_number(value)
    return dict(row)


def _noise(saved: Fields) -> NoiseModel:
    d = saved.numbers("d")
    zero = saved.number("zero") if "zero" in saved else 0.0
    c = saved.numbers("c") if "c" in saved else ()
    return saved.made("variance", "a variance", lambda value: NoiseModel(d, as_number(value), zero, c))


def _parameters(saved: Fields) -> dict[str, float]:
    return {name: saved.unbounded(name) for name in saved.names}


def _require_own(kind: Kind, parameters: Mapping[str, float]) -> None:
    missing = {*kind.model.own, *(() if kind.size is None else (kind.size,))} - parameters.keys()
    if missing:
        raise DataError.expected(f"parameters of a {kind.name} in a fit", f"no {sorted(missing)}", REMEDY)


def _covariance(saved: Fields, size: int) -> FloatArray:
    rows = saved.rows("covariance")
    if len(rows) != size or any(len(row) != size for row in rows):
        got = f"rows of {[len(row) for row in rows]}"
        raise DataError.expected(f"a covariance of {size} by {size} in a fit", got, REMEDY)
    return np.array(rows, dtype=np.float64).reshape(size, size)


def _evidence(saved: Fields) -> Evidence:
    found = Evidence(
        saved.number("gain_over_linear"),
        saved.number("gain_over_no_input"),
        saved.count("samples_left"),
        saved.count("samples_right"),
    )
    flags = ("closed_loop", "answered", "foreknown", "load_drifts")
    given: dict[str, Any] = {name: saved.flag(name) for name in flags if name in saved}
    if "free_moves" in saved:
        given["free_moves"] = saved.number("free_moves")
    if "rivals" in saved:
        given["rivals"] = saved.made("rivals", "rows of left, right, behind", _rivals)
    if "other_kind" in saved:
        given["other_kind"] = saved.made("other_kind", "a kind and how far it is ahead", _other_kind)
    if "by_prediction" in saved:
        given["by_prediction"] = saved.made("by_prediction", "a kind and its size", _by_prediction)
    if "unseen_moves" in saved:
        given["unseen_moves"] = saved.made("unseen_moves", "a deviation", _deviation)
    if "actuator_lag" in saved:
        given["actuator_lag"] = saved.made("actuator_lag", "a time", _deviation)
    if "gain_over_healthy" in saved:
        given["gain_over_healthy"] = saved.made("gain_over_healthy", "a gain", _gain)
    if "crossings" in saved:
        given["crossings"] = saved.made("crossings", "how often the dead zone was crossed", _crossings)
    return replace(found, **given)


def _gain(value: object) -> float | None:
    return None if value is None else as_number(value)


def _other_kind(pair: object) -> tuple[str, float]:
    name, ahead = as_list(pair)
    return kind_of(str(name)).name, as_number(ahead)


def _by_prediction(pair: object) -> tuple[str, float | None] | None:
    if pair is None:
        return None
    name, size = as_list(pair)
    return kind_of(str(name)).name, None if size is None else as_number(size)


def _deviation(saved: object) -> float:
    value = as_number(saved)
    if value < 0.0:
        raise ValueError("below 0")
    return value


def _crossings(saved: object) -> int:
    """Of older files: the end that was crossed less often, there and back."""
    return (
        round(2.0 * min(map(as_number, as_list(saved)))) if isinstance(saved, list | tuple) else round(as_number(saved))
    )


def _rivals(rows: object) -> tuple[tuple[float, float, float], ...]:
    return tuple(
        (left, right, behind) for left, right, behind in (map(as_number, as_list(row)) for row in as_list(rows))
    )


def _kinds(saved: Fields) -> KindChoice | None:
    """Null where only one kind was fitted."""
    if "kinds" not in saved:
        return None
    return saved.made("kinds", "a comparison of kinds", lambda data: None if data is None else _choice(data))


def _choice(data: Any) -> KindChoice:
    """Older files lack what came later."""
    shares = {
        name: {str(kind): as_number(value) for kind, value in data.get(name, {}).items()}
        for name in ("gains", "likelihoods", "firm")
    }
    sizes = data.get("excluded", {}).items()
    return KindChoice(
        str(data["best"]),
        **shares,
        confidence=as_number(data["confidence"]),
        runner_up=str(data["runner_up"]),
        excluded={str(kind): math.inf if size is None else as_number(size) for kind, size in sizes},
    )


def _made_up(data: Any) -> MadeUp | None:
    """Null where nothing is known."""
    if data is None:
        return None
    found = MadeUp.from_dict({name: {part: as_number(share) for part, share in data[name].items()} for name in data})
    if not all(0.0 <= share <= 1.0 for one in (found.op, found.pv) for share in (one.straight, one.held)):
        raise ValueError
    return found


def _span(pair: object) -> tuple[float, float]:
    low, high = map(as_number, as_list(pair))
    if not low < high:
        raise ValueError
    return low, high


def _widest(saved: Fields, status: Status, kind: Kind) -> float | None:
    """Null stands for none and for no bound; the interval of the size tells them apart."""
    if "widest" in saved or status not in HIDDEN or kind.size is None:
        return saved.number_or_none("widest")
    high = saved.part("intervals_95").pair(kind.size, -np.inf, np.inf)[1]
    return None if np.isfinite(high) else high


def _profiled(saved: Fields, kind: Kind) -> dict[str, tuple[float, float]]:
    if "profiled" in saved:
        return _ends(saved.part("profiled"))
    if not kind.family.kinks:
        return {}
    return {name: ends for name, ends in _ends(saved.part("intervals_95")).items() if name in kind.model.own}


def _ends(saved: Fields) -> dict[str, tuple[float, float]]:
    return {name: saved.pair(name, -np.inf, np.inf) for name in saved.names}
