"""What the type of a loop says about its process."""

from __future__ import annotations

# as most loops of a type, unless said otherwise
USUALLY = {"flow": False, "pressure": False, "temperature": False, "level": True}
# Whatever the data say: a flow follows its valve within seconds. A drum integrates its pressure, a slow temperature
# answers as an integrator within a record, and some levels regulate themselves.
NEVER = ("flow",)


def usually_integrates(loop_type: str) -> bool | None:
    """Whether the process of most loops of this type integrates; None where the type does not tell.

    Examples
    --------
    >>> usually_integrates("level"), usually_integrates("flow"), usually_integrates("")
    (True, False, None)
    """
    return USUALLY.get(loop_type)


def surely_integrates(loop_type: str) -> bool | None:
    """Whether the process integrates, where the type of the loop settles it; None where the data decide.

    Without it a drift of the load makes an integrating process of a flow, beside which its valve is not seen.

    Examples
    --------
    >>> surely_integrates("flow"), surely_integrates("pressure"), surely_integrates("level")
    (False, None, None)
    """
    return False if loop_type in NEVER else None
