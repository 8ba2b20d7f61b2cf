"""One line for people per message of ``lostmotion online``."""

from __future__ import annotations

from typing import Any

from lostmotion.report.digits import digits


def online_line(message: dict[str, Any]) -> str:
    """Line of a message of :mod:`lostmotion.online`.

    Examples
    --------
    >>> online_line({"kind": "event", "time": 12.0, "sample": 3, "name": "left", "message": "It moved."})
    '12.0  EVENT  It moved.'
    """
    if message["kind"] == "report":
        return f"{message['time']}  {message['status']}  {_numbers(message)}"
    if message["kind"] == "event":
        return f"{message['time']}  EVENT  {message['message']}"
    if message["kind"] == "start":
        columns = f"OP from {message['op']!r}, PV from {message['pv']!r}, every {message['dt']:g} s."
        return f"{message['source']}: {columns} {message['message']}".rstrip()
    return str(message["message"])


def _numbers(report: dict[str, Any]) -> str:
    if report["status"] in ("STARTING", "CANNOT_TELL", "NOT_SEEN", "WRONG_GAIN", "NOT_CONVERGED", "INTEGRATING"):
        return str(report["message"])
    words = ", ".join(f"{name} {_with_error(report[name])}" for name in ("width", "left", "right"))
    trend = report["trend"]
    if trend is not None and trend["significant"]:
        rate, error = digits(trend["per_day"], trend["per_day_standard_error"])
        words += f"; {rate} +/- {error} per day"
    if trend is not None and trend["limit"] is not None:
        words += f". {trend['limit']['message']}"
    further = [report["lag"]] if report["lag"] else []
    return " ".join([words, *further, *(stale["message"] for stale in report["no_information"] or [])])


def _with_error(number: dict[str, float | None]) -> str:
    value, error = number["value"], number["standard_error"]
    if value is None:
        return "unknown"
    shown = digits(value, float("inf") if error is None else error)
    return f"{shown[0]} +/- {shown[1]}"
