"""What percentages of OP refer to: the span given, 0 .. 100 or 0 .. 1 where it looks so, else the range seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.records import LoopRecord
from lostmotion.records.movement import PERCENT
from lostmotion.records.pieces import with_own_span

# of the tolerance: lost motion of a sound valve, as positioners resolve 0.1 to 0.2 % of span. Of 20 sound valves that
# were accused in an independent simulation ten had less by their fit, of the valves rightly accused none
SOUND = 0.25
TOLERANCE = 0.01  # of the span of OP: what is recommended for control valves (Cequeira et al. 2010, introduction)
FRACTION = (0.0, 1.0)  # limits of OP as a share of its span


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
        Whether it is a span; otherwise the range seen stands for it.
    note : str
        What was assumed; "" where it was given.
    """

    low: float
    high: float
    known: bool
    note: str = ""

    @property
    def ends(self) -> tuple[float, float]:
        """Both."""
        return self.low, self.high

    @property
    def percent(self) -> float:
        """1 % of it, in units of OP."""
        return 0.01 * (self.high - self.low)

    @property
    def words(self) -> str:
        """Of what a percentage is."""
        return "of span" if self.known else "of the OP range seen"


def op_span(record: LoopRecord) -> OpSpan:
    """Span of the OP of a record; one of other units counts as not given."""
    record = with_own_span(record)
    if record.op_span is not None:
        return OpSpan(*record.op_span, known=True)
    low, high = float(np.nanmin(record.op)), float(np.nanmax(record.op))
    for ends in (FRACTION, PERCENT):
        if ends[0] <= low and high <= ends[1]:
            said = f"The OP span was taken as {ends[0]:g} .. {ends[1]:g}; give op_span where it is not."
            return OpSpan(*ends, known=True, note=said)
    said = f"The OP span is unknown and not 0 .. 100: % are of the range seen, {low:.4g} .. {high:.4g}; give op_span."
    return OpSpan(low, high, known=False, note=said)
