"""Excellent, acceptable, fair, poor or open loop: the classes of the survey of 26,000 loops."""

from __future__ import annotations

from enum import StrEnum
from types import MappingProxyType

from lostmotion.arguments import finite
from lostmotion.diagnose.oscillation import Oscillation
from lostmotion.errors import ParameterError


class AuditClass(StrEnum):
    """Class of a loop, best first."""

    EXCELLENT = "excellent"
    ACCEPTABLE = "acceptable"
    FAIR = "fair"
    POOR = "poor"
    OPEN_LOOP = "open loop"


SURVEY = MappingProxyType(  # share of the loops, as cited by the paper
    {
        AuditClass.EXCELLENT: 0.16,
        AuditClass.ACCEPTABLE: 0.16,
        AuditClass.FAIR: 0.22,
        AuditClass.POOR: 0.10,
        AuditClass.OPEN_LOOP: 0.36,
    }
)

# Least Harris index (1 is best) of excellent, acceptable and fair. Chosen here, not published: a loop of a fast
# process comes nearer to minimum variance than one of a slow one, and a level is often meant to swing.
LEAST_INDEX = MappingProxyType(
    {
        "flow": (0.70, 0.50, 0.25),
        "pressure": (0.60, 0.40, 0.20),
        "temperature": (0.50, 0.30, 0.15),
        "analyser": (0.50, 0.30, 0.15),
        "concentration": (0.50, 0.30, 0.15),
        "level": (0.40, 0.20, 0.10),
        "other": (0.60, 0.40, 0.20),
    }
)
MOST_OPEN = 0.30  # share of time in manual or at a limit; see the notes
OSCILLATING_SHARE = 0.5  # of the variance; chosen here


def audit_class(
    index: float, loop_type: str = "other", oscillation: Oscillation | None = None, open_share: float = 0.0
) -> AuditClass:
    """Class of a loop from its Harris index, its oscillation and its time in open loop.

    Parameters
    ----------
    index : float
        Minimum variance over variance, 0 to 1; of a range of delays, the index of the delay believed in.
    loop_type : {"flow", "pressure", "temperature", "analyser", "concentration", "level", "other"}
        What PV measures.
    oscillation : Oscillation, optional
        Of PV. A regular one with half of the variance moves the loop down by one class.
    open_share : float
        Share of the time, 0 to 1, in manual or with OP at a limit.

    Raises
    ------
    ParameterError
        An index or a share outside 0 to 1, an unknown loop type.

    Notes
    -----
    Desborough and Miller (2002), "Increasing customer value of industrial control performance monitoring:
    Honeywell's experience", AIChE Symposium Series 98, no. 326. The survey formed the classes from a minimum
    variance index and a measure of oscillation, tuned for each type of measurement and then corrected by what
    practitioners expected; it prints no limits. Classes and their shares are the survey's; the limits of
    ``LEAST_INDEX`` and the step down for an oscillation are this package's, so shares found with them must not be
    compared digit by digit with ``SURVEY``. The 30 % of time after which a loop counts as open are those that
    reviews report of the survey.

    Examples
    --------
    >>> audit_class(0.8, "flow").value, audit_class(0.8, "flow", open_share=0.4).value
    ('excellent', 'open loop')
    """
    for name, value in (("index", index), ("open_share", open_share)):
        if not 0.0 <= finite(name, value) <= 1.0:
            raise ParameterError.expected(f"{name} from 0 to 1", value, "give a share")
    if loop_type not in LEAST_INDEX:
        raise ParameterError.expected(f"a loop type of {sorted(LEAST_INDEX)}", repr(loop_type), "choose one of these")
    if open_share > MOST_OPEN:
        return AuditClass.OPEN_LOOP
    place = sum(index < least for least in LEAST_INDEX[loop_type])
    if oscillation is not None and oscillation.regular and oscillation.share >= OSCILLATING_SHARE:
        place = min(place + 1, 3)
    return list(AuditClass)[place]
