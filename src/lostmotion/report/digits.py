"""Numbers with the digits that their standard error allows."""

from __future__ import annotations

import math

FINEST = 0.02  # of a size: no interval is finer than the digits of this error
NORMAL = 1.96  # standard errors of a 95 % interval to either side
WIDER = 1.1  # times a standard error, from which on an interval counts more than it
HOPELESS = 1e3  # a standard error this many times its value says nothing about it


def digits(value: float, error: float) -> tuple[str, str]:
    """Value and standard error, both to two digits of the error.

    Examples
    --------
    >>> digits(1.00234, 0.0031)
    ('1.0023', '0.0031')
    >>> digits(12345.6, 210.0)
    ('12350', '210')
    >>> digits(3.0, math.inf)
    ('3', 'unknown')
    """
    if not math.isfinite(value):
        return "unknown", "unknown"
    if math.isfinite(error) and error > HOPELESS * max(abs(value), 1.0):
        return "unknown", "unknown"
    if not math.isfinite(error):
        return f"{value:.3g}", "unknown"
    if error <= 1e-12 * abs(value):
        return f"{value:.6g}", "given"
    places = 1 - math.floor(math.log10(error))
    if places < 0:
        return f"{round(value, places):.0f}", f"{round(error, places):.0f}"
    return f"{value:.{places}f}", f"{error:.{places}f}"


def error_of(interval: tuple[float, float], error: float) -> float:
    """Standard error that is shown beside a 95 % interval: that of the interval, where it counts more than `error`.

    The likelihood of a valve that sticks has a narrow maximum: its curvature says nothing of how far the size may be.

    Examples
    --------
    >>> round(error_of((2.0, 2.7), 0.00065), 2), error_of((1.9, 2.3), 0.1), error_of((0.0, math.inf), 0.1)
    (0.18, 0.1, 0.1)
    """
    own = (interval[1] - interval[0]) / (2.0 * NORMAL)
    return own if math.isfinite(own) and own > WIDER * error else error


def span(low: float, high: float, error: float) -> str:
    """Interval with the digits of the standard error.

    Examples
    --------
    >>> span(0.99611, 1.00853, 0.0031)
    '0.9961 .. 1.0085'
    >>> span(-math.inf, math.inf, math.inf)
    'anywhere'
    """
    if not (math.isfinite(low) or math.isfinite(high)):
        return "anywhere"
    if not math.isfinite(error) or error <= 0:
        error = max((high - low) / 4.0, 1e-300) if math.isfinite(high - low) else 1.0
    ends = [digits(end, error)[0] if math.isfinite(end) else "open" for end in (low, high)]
    return f"{ends[0]} .. {ends[1]}"


def bracketed(unit: str) -> str:
    """Unit behind a number, in brackets as at the axes of figures; nothing where it is not known.

    Brackets keep "4.05 +/- 0.10 [%]" from being read as a relative error.

    Examples
    --------
    >>> bracketed("t/h"), bracketed("")
    (' [t/h]', '')
    """
    return f" [{unit}]" if unit else ""


def plain(value: float) -> str:
    """Three digits, without an exponent for numbers of daily life.

    Examples
    --------
    >>> plain(5063.2), plain(37.64), plain(0.0123), plain(3.2e8)
    ('5060', '37.6', '0.0123', '320000000')
    """
    return f"{float(f'{value:.3g}'):.9g}"


def signed(value: float) -> str:
    """Number with its sign, "0" where it rounds to nothing."""
    return "0" if abs(value) < 0.005 else f"{value:+.2f}"
