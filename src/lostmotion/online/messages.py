"""Reports and events as dictionaries: one JSON line each."""

from __future__ import annotations

from typing import Any

import numpy as np

from lostmotion.errors import Status
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent, RecursiveEstimate
from lostmotion.online.timeline import Timeline
from lostmotion.online.trend import Line

STALE = 1000  # samples without information that are worth a sentence
DAY = 86400.0  # s
LAGS = 3.0  # standard errors between estimate and trend that are worth a sentence
Z95 = 1.959963984540054  # standard errors in the half-width of a 95 % interval
SHOWN = ("left", "right", "width", "slope_ratio")
CHANGED = {
    "left": "The left break point has moved",
    "right": "The right break point has moved",
    "process": "The gain of the process behind the actuator has changed",
    "offset": "The output at rest has changed: a load has come or gone",
}
REACHED = {
    "reached": "The line through the widths has reached the limit.",
    "away": "The dead zone gets narrower.",
    "level": "No significant change of the width, so no time is given.",
}


def report(estimate: RecursiveEstimate | None, sample: int, timeline: Timeline, failure: str = "") -> dict[str, Any]:
    """State of the estimate; None while the first window fills, or where there is none because of a `failure`."""
    head = {"kind": "report", "time": timeline.text(timeline.now), "sample": sample}
    if estimate is not None and estimate.status is Status.INTEGRATING:
        state = {"status": estimate.status.name, "message": estimate.status.value}
        return {**head, **state, **dict.fromkeys((*SHOWN, "no_information"))}
    if estimate is None:
        words = f"No estimate yet after {sample} samples: the first window fills, or OP has told nothing in it."
        state = {"status": "STARTING", "message": words}
        if failure:
            words = f"The estimate has left what is possible ({failure}). Check the orders and the order of the noise."
            state = {"status": Status.NOT_CONVERGED.name, "message": words}
        return {**head, **state, **dict.fromkeys((*SHOWN, "no_information"))}
    stale = _stale(estimate, timeline)
    return {
        **head,
        "status": estimate.status.name,
        "message": _words(estimate),
        **{name: number(estimate, name) for name in SHOWN},
        "no_information": stale or None,
    }


def number(estimate: RecursiveEstimate, name: str) -> dict[str, float | None]:
    """Value, standard error and 95 % interval, as far as they are earned: open where nothing is known."""
    error = float(np.sqrt(max(estimate.covariance[(list(estimate.parameters).index(name),) * 2], 0.0)))
    low, high = (estimate.parameters[name] + side * Z95 * error for side in (-1.0, 1.0))
    if name == "width":
        return _numbers(estimate.parameters[name], error, max(low, 0.0), high)
    if estimate.status in (Status.NOT_SEEN, Status.CANNOT_TELL):
        return _numbers(np.nan, np.nan, np.nan, np.nan)
    return _numbers(estimate.parameters[name], error, low, high)


def _numbers(value: float, error: float, low: float, high: float) -> dict[str, float | None]:
    found = {"value": value, "standard_error": error, "low": low, "high": high}
    return {name: _finite(value) for name, value in found.items()}


def change(event: ChangeEvent, timeline: Timeline) -> dict[str, Any]:
    """Event: a parameter has moved."""
    since = timeline.at(event.since)
    words = f"{CHANGED.get(event.name, event.name)} from {event.before:.4g} to {event.after:.4g}"
    return {
        "kind": "event",
        "time": timeline.text(timeline.at(event.sample)),
        "sample": event.sample,
        "name": event.name,
        "message": f"{words} (standard error {event.standard_error:.2g}), since about sample {event.since}.",
        "since": timeline.text(since),
        "since_sample": event.since,
        "before": _finite(event.before),
        "after": _finite(event.after),
        "standard_error": _finite(event.standard_error),
    }


def above_limit(estimate: RecursiveEstimate, limit: float, sample: int, timeline: Timeline) -> dict[str, Any]:
    """Event: the width is above its limit."""
    value, error = estimate.parameters["width"], estimate.standard_errors["width"]
    return {
        "kind": "event",
        "time": timeline.text(timeline.now),
        "sample": sample,
        "name": "width limit",
        "message": f"The dead zone is wider than its limit of {limit:.4g}: {value:.4g} (standard error {error:.2g}).",
        "limit": limit,
        "after": _finite(value),
        "standard_error": _finite(error),
    }


def trend(line: Line | None, limit: float | None, timeline: Timeline) -> dict[str, Any] | None:
    """Slope of the width and the time to its limit; None with fewer than 4 points."""
    if line is None:
        return None
    value, error = line.at(timeline.running)
    return {
        "points": line.points,
        "left_out": line.left_out,
        "since": timeline.text(timeline.stamp(line.since)),
        "until": timeline.text(timeline.stamp(line.until)),
        "fits": line.fits,
        "chi_square": line.chi_square,
        "probability": line.probability,
        "width_now": value if line.fits else None,
        "width_now_standard_error": error if line.fits else None,
        "per_day": line.slope * DAY if line.fits else None,
        "per_day_standard_error": line.slope_error * DAY if line.fits else None,
        "significant": line.significant,
        "limit": None if limit is None else _limit(line, limit, timeline),
    }


def lag(estimate: RecursiveEstimate | None, line: Line | None, timeline: Timeline) -> str | None:
    """Sentence where the estimate still remembers other widths than the trend says there are now."""
    if estimate is None or line is None or not line.significant:
        return None
    (now, error), width = line.at(timeline.running), number(estimate, "width")
    own = width["standard_error"]
    if own is None or abs(estimate.parameters["width"] - now) < LAGS * np.hypot(own, error):
        return None
    return (
        f"By the trend the width is {now:.4g} (standard error {error:.2g}) by now; the estimate remembers older ones, "
        "beyond its interval. A smaller forgetting factor follows faster."
    )


def _limit(line: Line, limit: float, timeline: Timeline) -> dict[str, Any]:
    reach = line.reach(limit)
    if reach is None:
        words = "The latest widths do not lie on a straight line, so no time is given."
        return {"width": limit, "state": "no line", "message": words, "time": None, "earliest": None, "latest": None}
    now = timeline.running

    def date(moment: float | None) -> str | float | None:
        return None if moment is None else timeline.text(timeline.stamp(moment))

    def left(moment: float | None) -> str:
        return "open" if moment is None else f"{(moment - now) / DAY:.3g}"

    words = REACHED.get(reach.state, "")
    if reach.time is not None:
        ends = f"{left(reach.earliest)} to {left(reach.latest)}"
        words = f"The limit is reached in about {left(reach.time)} days if it goes on like this (95 %: {ends})."
    elif reach.earliest is not None:
        words += f" Not before {left(reach.earliest)} days (97.5 %)."
    return {
        "width": limit,
        "state": reach.state,
        "message": words,
        "time": date(reach.time),
        "earliest": date(reach.earliest),
        "latest": date(reach.latest),
    }


def _words(estimate: RecursiveEstimate) -> str:
    if estimate.status is not Status.NOT_SEEN:
        return str(estimate.status.value)
    high = number(estimate, "width")["high"]
    bound = "" if high is None else f" One wider than {high:.3g} would have been seen (95 %)."
    return f"No dead zone is seen.{bound}"


def _stale(estimate: RecursiveEstimate, timeline: Timeline) -> list[dict[str, Any]]:
    found = []
    for name, sample in (estimate.informed or {}).items():
        ago = estimate.samples - sample
        if ago > STALE:
            words = f"No information about the {name} break point for {ago} samples: OP hardly crossed it, or masked."
            since = timeline.text(timeline.at(sample))
            found.append({"name": name, "since": since, "since_sample": sample, "samples": ago, "message": words})
    return found


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
