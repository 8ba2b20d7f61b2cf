"""What the diagnosis of a window is worth: whether it can tell, and whether it matters; in a number and in words."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.records import limits

ENOUGH_ROWS = 1000  # at the natural time scale, of which a diagnosis tells what it can
ENOUGH_TURNS = 20.0
ENOUGH_RANGE = 3.0  # times the tolerance, from which on the range of OP shows all that matters
LOUD = 2.0  # % of the span of PV: an error of control of this deviation matters in any loop
LEAST = 0.05  # of what a diagnosis is worth wherever it can tell something: no loop is quiet for sure
SWING, ERROR, CLASS = 0.5, 0.3, 0.2  # shares of what matters
MASTER = "a master, without a valve of its own: that of its slave, {}, is the one to look at"
POOR = {"excellent": 0.0, "acceptable": 0.2, "fair": 0.7, "poor": 1.0}


@dataclass(frozen=True)
class Seen:
    """What the screen has seen of a window.

    Attributes
    ----------
    fit : bool
        Data allow a judgement.
    acting : int
        Rows in automatic with OP off its limits.
    manual, limited : float
        Shares of time.
    op_range : float
        From the 2 % to the 98 % quantile of OP in these rows, in % of span.
    turns : float
        Turns of OP there by more than its noise.
    variability : float, optional
        Deviation of the error of control, % of span of PV; None: span or error not known.
    power : float
        Of the oscillation; 0 where there is none.
    steady : bool
        It swings.
    performance : str
    tolerance : float
        % of span of OP.
    slave : str
        Loop whose set point OP is; empty: OP moves a valve.
    """

    fit: bool
    acting: int
    manual: float
    limited: float
    op_range: float
    turns: float
    variability: float | None
    power: float
    steady: bool
    performance: str
    tolerance: float
    slave: str = ""


def worth(seen: Seen, problem: str) -> tuple[float, str]:
    """Value of a diagnosis (0: nothing to be told, to 1), and why in words.

    Parameters
    ----------
    seen : Seen
    problem : str
        What is wrong with the data where they are not fit.

    Examples
    --------
    >>> quiet = Seen(True, 86400, 0.0, 0.0, 0.2, 5.0, 0.1, 0.1, False, "acceptable", 1.0)
    >>> worth(quiet, "")
    (0.0, 'OP moves by 0.2 % of span: a lost motion of 1 % cannot show')
    """
    barred = _barred(seen, problem)
    if barred:
        return 0.0, barred
    can = min(seen.acting / ENOUGH_ROWS, 1.0) * min(seen.turns / ENOUGH_TURNS, 1.0)
    if not seen.steady:  # a small lost motion makes a small swing, which is there to be explained
        can *= min(seen.op_range / (ENOUGH_RANGE * seen.tolerance), 1.0)
    swing = seen.power if seen.steady else 0.0
    error = 0.5 if seen.variability is None else min(seen.variability / LOUD, 1.0)
    matters = SWING * swing + ERROR * error + CLASS * POOR.get(seen.performance, 0.5)
    return float(np.clip(can * (LEAST + (1.0 - LEAST) * matters), 0.0, 1.0)), _words(seen)


def _barred(seen: Seen, problem: str) -> str:
    """Why nothing can be told; "" where something can."""
    if not seen.fit:
        return f"data not fit for use: {problem}"
    if seen.acting < limits.SHORT:
        where = "in manual" if seen.manual >= seen.limited else "at a limit of OP"
        return f"{where} nearly all the time: no closed loop to be judged"
    if seen.slave:
        return MASTER.format(seen.slave)
    if seen.op_range < seen.tolerance and not seen.steady:
        return f"OP moves by {seen.op_range:.2g} % of span: a lost motion of {seen.tolerance:.2g} % cannot show"
    if seen.turns < limits.FEW_REVERSALS:
        return f"OP turns {seen.turns:.0f} times: lost motion shows only where it turns"
    return ""


def _words(seen: Seen) -> str:
    said = ["swings regularly"] if seen.steady else []
    if seen.variability is not None and seen.variability >= 0.5 * LOUD:
        said.append(f"error of control {seen.variability:.2g} % of span")
    if seen.performance in ("fair", "poor"):
        said.append(f"performance {seen.performance}")
    return "; ".join(said) or "quiet, but OP moves enough to tell"
