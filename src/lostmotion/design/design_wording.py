"""Times in words."""

from __future__ import annotations


def in_words(seconds: float) -> str:
    """Seconds, minutes, hours or days with three digits.

    Examples
    --------
    >>> in_words(90.0), in_words(7200.0), in_words(400000.0)
    ('90 s', '2 h', '4.63 days')
    """
    for size, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"
