"""The oscillation of the error of control, and what its amplitude says of where it comes from.

Noise builds the oscillation of a linear loop that hardly settles up and takes it away: after Rayleigh its amplitude has
a deviation of 0.52 of its mean. A limit cycle, and what is forced from outside, keep theirs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

import numpy as np

from lostmotion.diagnose.control_error.rows import ScreenRows
from lostmotion.diagnose.control_error.spectrum import spectrum_of
from lostmotion.diagnose.control_error.swing import amplitude_spread, swing_of
from lostmotion.records import LoopRecord

STEADY, WANDERS = 0.1, 0.4  # spread of an amplitude: noise builds up none below; of a loop that rings it is about 0.5
RINGS = 5.0  # regularity from which on an oscillation that comes and goes is the loop's own
FEWEST_PERIODS = 30.0  # a loop with a damping of 0.01 keeps an amplitude for 16 periods: in fewer it looks steady
LEAST_POWER = 0.15  # share of the variance: less is no oscillation that anybody sees


@dataclass(frozen=True)
class ErrorOscillation:
    """Oscillation of the error of control in all of a record.

    Attributes
    ----------
    period : float
        Seconds; NaN where it is not known.
    regularity : float
    power : float
        Share of the variance.
    spread : float
        Deviation of its amplitude over the mean; NaN where there are too few periods.
    periods : float
        Of it in the record.
    """

    period: float
    regularity: float
    power: float
    spread: float = nan
    periods: float = inf

    @property
    def regular(self) -> bool:
        """Whether the loop oscillates regularly, as published: regularity above 1."""
        return self.regularity > 1.0 and self.power > LEAST_POWER

    @property
    def rings(self) -> bool:
        """Whether the loop hardly settles: it oscillates very regularly, with an amplitude that comes and goes."""
        return self.regular and self.spread >= WANDERS and self.regularity >= RINGS

    @property
    def steady(self) -> bool:
        """Whether it keeps its amplitude, which noise lets no linear loop do, whatever its tuning."""
        return self.regular and self.spread < STEADY and self.periods >= FEWEST_PERIODS


def error_oscillation(record: LoopRecord) -> ErrorOscillation | None:
    """Measure it, as an audit screens the same rows; None where nothing oscillates."""
    with np.errstate(all="ignore"):  # huge values overflow in squares; what is not finite is left out
        error = ScreenRows(record).error
        spectrum = spectrum_of(error, record.dt)
        swing = None if spectrum is None else swing_of(error, spectrum, record.dt)
        if swing is None:
            return None
        spread = amplitude_spread(error, swing.period, record.dt) if swing.regularity > 1.0 else None
    periods = len(record) * record.dt / swing.period
    return ErrorOscillation(swing.period, swing.regularity, swing.power, nan if spread is None else spread, periods)
