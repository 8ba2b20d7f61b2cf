"""What percentages of OP refer to: its span, the one that its values suggest, else the range seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.diagnose.severity import severity_of
from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.records.pieces import with_own_span
from lostmotion.records.span import Span, possible_spans

# of the tolerance: lost motion of a sound valve, as positioners resolve 0.1 to 0.2 % of span. Of 20 sound valves that
# were accused in an independent simulation ten had less by their fit, of the valves rightly accused none
SOUND = 0.25
TOLERANCE = 0.01  # of the span of OP: what is recommended for control valves (Cequeira et al. 2010, introduction)


def checked_tolerance(tolerance: float) -> float:
    """A share of the span between 0 and 1.

    Raises
    ------
    ParameterError
    """
    if not 0.0 < tolerance < 1.0:
        raise ParameterError.expected("a tolerance between 0 and 1, a share of the span", tolerance, "e.g. 0.01")
    return tolerance


@dataclass(frozen=True)
class OpSpan:
    """Span of OP.

    Attributes
    ----------
    low, high : float
        In units of OP.
    known : bool
        Whether it is a span; otherwise one of several that the values allow, or the range seen, stands for it.
    note : str
        What was assumed; "" where it was given.
    others : tuple of (float, float)
        Other spans that OP may have.
    """

    low: float
    high: float
    known: bool
    note: str = ""
    others: tuple[Span, ...] = ()

    @property
    def ends(self) -> Span:
        """Both."""
        return self.low, self.high

    @property
    def percent(self) -> float:
        """1 % of it, in units of OP."""
        return 0.01 * (self.high - self.low)

    @property
    def strictest_percent(self) -> float:
        """1 % of the narrowest span that OP may have, in units of OP."""
        return 0.01 * min(high - low for low, high in (self.ends, *self.others))

    @property
    def words(self) -> str:
        """Of what a percentage is."""
        if self.others:
            return f"of an assumed span {self.low:g} .. {self.high:g}"
        return "of span" if self.known else "of the OP range seen"

    def severity(self, size: float) -> str:
        """Severity of a size in units of OP, where it is the same for every span that OP may have; else "unknown"."""
        if not (self.known or self.others):
            return "unknown"
        found = {severity_of(size / (0.01 * (high - low))) for low, high in (self.ends, *self.others)}
        return found.pop() if len(found) == 1 else "unknown"

    def severity_of(self, verdict: str, kind: str, size: float) -> str:
        """Severity of a verdict: of the size where the actuator is named, "none" of any other, but for "cannot tell".

        Examples
        --------
        >>> span = OpSpan(0.0, 100.0, True)
        >>> span.severity_of("backlash", "actuator", 3.0), span.severity_of("cannot tell", "unknown", float("nan"))
        ('high', 'unknown')
        """
        if kind == "actuator":
            return self.severity(size)
        return "unknown" if verdict == "cannot tell" else "none"

    def request(self, size: float) -> str:
        """What to give, where the severity of a size depends on a span that is not known; else empty.

        Examples
        --------
        >>> OpSpan(0.0, 100.0, False, others=((4.0, 20.0),)).request(0.48)
        'Give op_span=(low, high), the span of OP: the severity is low for 0 .. 100, high for 4 .. 20.'
        """
        if not np.isfinite(size) or self.severity(size) != "unknown":
            return ""
        if not self.others:
            return "Give op_span=(low, high), the span of OP: without it the severity is not known."
        spans = (self.ends, *self.others)
        each = [f"{severity_of(100.0 * size / (high - low))} for {low:g} .. {high:g}" for low, high in spans]
        return f"Give op_span=(low, high), the span of OP: the severity is {', '.join(each)}."


def op_span(record: LoopRecord) -> OpSpan:
    """Span of the OP of a record; one of other units counts as not given."""
    record = with_own_span(record)
    if record.op_span is not None:
        return OpSpan(*record.op_span, known=True)
    return span_of_values(record.op_unit, float(np.nanmin(record.op)), float(np.nanmax(record.op)))


def span_of_values(unit: str, low: float, high: float) -> OpSpan:
    """Span of OP that moves between `low` and `high`, where none was given."""
    possible = possible_spans(unit, np.array([low, high]))
    if not possible:
        unknown, asks = ("", "") if unit else (" and not 0 .. 100", "; give op_span")  # else a note of the record asks
        said = f"The OP span is unknown{unknown}: % are of the range seen, {low:.4g} .. {high:.4g}{asks}."
        return OpSpan(low, high, known=False, note=said)
    (first, *others), doubt = possible, ""
    if others:
        doubt = " or ".join(f"{one:g} .. {other:g}" for one, other in others)
        doubt = f", but OP stays within {low:.4g} .. {high:.4g}, so that it may be {doubt} as well"
    said = f"The OP span was taken as {first[0]:g} .. {first[1]:g}{doubt}; give op_span where it is not."
    return OpSpan(*first, known=not others, note=said, others=tuple(others))
