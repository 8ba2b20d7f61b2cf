"""Span of OP: what its unit stands for (4 .. 20 mA), what its values allow, and values beyond it."""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.records import limits

Span = tuple[float, float]
Bools = npt.NDArray[np.bool_]

PERCENT: Span = (0.0, 100.0)
FRACTION: Span = (0.0, 1.0)
# Signals to an actuator, by unit: the usual span first (IEC 60381-1, IEC 60381-2 and IEC 60382, ISA-7.0.01).
SIGNALS: dict[str, tuple[Span, ...]] = {
    "%": (PERCENT,),
    "fraction": (FRACTION,),
    "ma": ((4.0, 20.0), (0.0, 20.0)),
    "v": ((1.0, 5.0), (0.0, 10.0)),
    "psi": ((3.0, 15.0), (6.0, 30.0)),
    "bar": ((0.2, 1.0),),
    "kpa": ((20.0, 100.0),),
}
UNIT_NAMES = {
    **dict.fromkeys(("pct", "percent", "per cent", "prozent", "pourcent", "por ciento", "por cento", "% open"), "%"),
    **dict.fromkeys(("p.u.", "pu", "per unit"), "fraction"),
    **dict.fromkeys(("madc", "ma dc"), "ma"),
    **dict.fromkeys(("vdc", "v dc", "volt", "volts"), "v"),
    "psig": "psi",
    "barg": "bar",
}
_STATED = re.compile(
    r"(?P<low>-?\d+(?:[.,]\d+)?)\s*(?:-|\u2013|\.{2,3}|\u2026|to|bis)\s*(?P<high>\d+(?:[.,]\d+)?).{0,8}"
)
# of a span, that its values may lie beyond: cards go to 3.6 and 20.5 mA (NAMUR NE 43); where that fits no span, to
# 21 mA, and controllers to -6.9 and 106.9 %
MARGINS = (0.035, 0.1)
STRAY_SHARE = 0.01  # of rows: a loop that was switched off sends 0 mA


def is_signal(unit: str) -> bool:
    """Whether a unit has a span of its own.

    Examples
    --------
    >>> is_signal("mA"), is_signal("4-20 mA"), is_signal("Percent"), is_signal("counts")
    (True, True, True, False)
    """
    return bool(_spans(unit))


def spans_of_unit(unit: str, values: FloatArray) -> tuple[Span, ...]:
    """Spans that the unit of OP stands for and that hold its values, the usual one first; empty: none does.

    Examples
    --------
    >>> spans_of_unit("mA", np.array([8.0, 14.0])), spans_of_unit("V", np.array([0.0, 9.0]))
    (((4.0, 20.0),), ((0.0, 10.0),))

    OP in % that never exceeds 1 may be a share of 1, as a spreadsheet stores a cell that it shows in %.

    >>> spans_of_unit("%", np.array([0.2, 0.8]))
    ((0.0, 100.0), (0.0, 1.0))
    """
    found = [span for margin in MARGINS for span in _spans(unit) if _holds(span, values, margin)]
    if found[:1] == [PERCENT] and _within(FRACTION, values):
        return (PERCENT, FRACTION)
    return tuple(found[:1])


def possible_spans(unit: str, values: FloatArray) -> tuple[Span, ...]:
    """Spans that OP may have, the most likely one first; empty: not known.

    Without a unit, values of 0 .. 1 are a share of 1, others within 0 .. 100 are in %, or are a signal whose span
    holds them.

    Examples
    --------
    >>> possible_spans("", np.array([30.0, 60.0])), possible_spans("", np.array([8.0, 14.0]))
    (((0.0, 100.0),), ((0.0, 100.0), (4.0, 20.0), (3.0, 15.0)))
    >>> possible_spans("", np.array([0.2, 0.8])), possible_spans("counts", np.array([30.0, 60.0]))
    (((0.0, 1.0),), ())
    """
    if unit:
        return spans_of_unit(unit, values)
    if _within(FRACTION, values):
        return (FRACTION,)
    if not _within(PERCENT, values):
        return ()
    signals = [SIGNALS["ma"][0], SIGNALS["psi"][0], *SIGNALS["v"]]
    return (PERCENT, *(span for span in signals if _holds(span, values, MARGINS[0])))


def about_unit(unit: str, values: FloatArray) -> tuple[Span | None, str]:
    """Span of OP by its unit where it leaves no doubt, and a sentence on what was taken; "" where that is plain.

    Examples
    --------
    >>> about_unit("mA", np.array([8.0, 14.0]))[1]
    'OP is in mA: its span was taken as 4 .. 20, not 0 .. 20; give op_span=(low, high) where it is another.'
    >>> about_unit("%", np.array([8.0, 14.0])), about_unit("counts", np.array([8.0, 14.0]))[0]
    (((0.0, 100.0), ''), None)
    """
    found, usual = spans_of_unit(unit, values), _spans(unit)
    if not unit or len(found) > 1:
        return None, ""
    if found == (PERCENT,):
        return PERCENT, ""
    if found:
        rest = [_shown(span) for span in usual if span != found[0]]
        but = f", not {' or '.join(rest)}" if rest else ""
        said = f"OP is in {unit}: its span was taken as {_shown(found[0])}{but}"
        return found[0], f"{said}; give op_span=(low, high) where it is another."
    why = f"but lies outside {' and '.join(map(_shown, usual))}" if usual else "which has no usual span"
    return None, f"OP is in {unit}, {why}: its span is not known; give op_span=(low, high)."


def _shown(span: Span) -> str:
    return f"{span[0]:g} .. {span[1]:g}"


def beyond(values: FloatArray, span: Span | None) -> Bools:
    """Rows in which OP is recorded outside its span, where the actuator cannot follow; shape (n,).

    Examples
    --------
    >>> beyond(np.array([-4.0, 0.0, 101.0]), (0.0, 100.0))
    array([ True, False,  True])
    """
    if span is None:
        return np.zeros(len(values), dtype=np.bool_)
    margin = limits.FINE_STEP * (span[1] - span[0])
    outside: Bools = (values < span[0] - margin) | (values > span[1] + margin)
    return outside


def of_other_units(values: FloatArray, span: Span | None) -> bool:
    """Whether values lie so that their span must be that of other units; not every such span shows.

    Examples
    --------
    >>> wave = np.sin(np.arange(300) / 20.0)
    >>> of_other_units(2.0 * wave, (0.0, 100.0)), of_other_units(52.0 + 60.0 * wave, (0.0, 100.0))
    (True, False)
    """
    if span is None or not np.any(~np.isnan(values)) or np.mean(beyond(values, span)) <= limits.OUTSIDE_SHARE:
        return False
    low, high, width = float(np.nanmin(values)), float(np.nanmax(values)), span[1] - span[0]
    far = max(span[0] - low, high - span[1]) > limits.FAR_OUTSIDE * width
    about_zero = float(np.mean(values < span[0])) > limits.OUTSIDE_SHARE  # at the upper end it may be a limit
    return far or (about_zero and high - low < limits.SMALL_RANGE * width)


def _spans(unit: str) -> tuple[Span, ...]:
    """Spans of a unit, or the one that it states itself ("4-20 mA")."""
    bare = " ".join(unit.strip("[]() ").lower().split())
    stated = _STATED.fullmatch(bare)
    if stated is None:
        return SIGNALS.get(UNIT_NAMES.get(bare, bare), ())
    low, high = (float(stated[end].replace(",", ".")) for end in ("low", "high"))
    return ((low, high),) if low < high else ()


def _holds(span: Span, values: FloatArray, margin: float) -> bool:
    """Whether all but a few values lie in a span, or a little beyond."""
    known = values[np.isfinite(values)]
    room = margin * (span[1] - span[0])
    outside = (known < span[0] - room) | (known > span[1] + room)
    return bool(known.size) and float(np.mean(outside)) <= STRAY_SHARE and not of_other_units(values, span)


def _within(span: Span, values: FloatArray) -> bool:
    known = values[np.isfinite(values)]
    return bool(known.size) and span[0] <= float(known.min()) and float(known.max()) <= span[1]
