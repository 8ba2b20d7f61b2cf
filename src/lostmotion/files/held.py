"""Tags with times of their own, whose rows are samples already: each value holds until the next one of its tag."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import TimeError
from lostmotion.files.resampled import usual_step
from lostmotion.files.table import Table
from lostmotion.records.sampling import Bools

LONGEST_HOLE = 20  # rows without PV: over a longer hole nothing is made up, as in resampling


@dataclass(frozen=True, eq=False)
class Held:
    """Rows in which any tag of the loop has a value, and signals without empty cells.

    Attributes
    ----------
    rows : ndarray of int, shape (n,)
        Rows of the table, from 0.
    signals : dict of ndarray, shape (n,)
        By role.
    made_up : (float, float)
        Shares of OP and PV that lie between stored values.
    notes : tuple of str
        What was done; empty where nothing was.
    """

    rows: IntArray
    signals: dict[str, FloatArray]
    made_up: tuple[float, float]
    notes: tuple[str, ...] = ()


def held(table: Table, columns: Mapping[str, str], signals: Mapping[str, FloatArray]) -> Held:
    """Fill what a historian left out because it had not changed.

    Parameters
    ----------
    table : Table
        Rows in the order of time; an empty cell holds no new value, a bad one is NaN or a word.
    columns : mapping of str to str
        Column of each role.
    signals : mapping of ndarray, shape (n,)
        By role.

    Notes
    -----
    OP, SP and the position hold; PV is taken on straight lines, but not over holes of more than 20 rows. A bad value is
    no measurement, and stays missing.

    Examples
    --------
    >>> import narwhals.stable.v2 as nw
    >>> import polars as pl
    >>> frame = pl.DataFrame({"OP": [1.0, 2.0, None], "PV": [3.0, None, 5.0]})
    >>> signals = {"op": np.array([1, 2, np.nan]), "pv": np.array([3, np.nan, 5])}
    >>> found = held(Table(nw.from_native(frame, eager_only=True), "a"), {"op": "OP", "pv": "PV"}, signals)
    >>> found.signals["op"], found.signals["pv"]
    (array([1., 2., 2.]), array([3., 4., 5.]))
    """
    absent = {role: table.column(columns[role]).is_null().to_numpy() for role in signals}
    rows = np.flatnonzero(~(absent["op"] & absent["pv"]))
    absent = {role: empty[rows] for role, empty in absent.items()}
    kept = {role: values[rows] for role, values in signals.items()}
    if not any(empty.any() for empty in absent.values()):
        return Held(rows, kept, (0.0, 0.0))
    filled = {role: (_on_lines if role == "pv" else _last)(kept[role], absent[role]) for role in kept}
    shares = tuple(float(np.mean(absent[role] & ~np.isnan(filled[role]))) for role in ("op", "pv"))
    named = [role.upper() if len(role) == 2 else role for role, empty in absent.items() if empty.any()]
    note = (
        f"Tags have times of their own: {', '.join(named)} filled between stored values, PV on lines, others held: "
        f"{100 * shares[0]:.0f} % of OP, {100 * shares[1]:.0f} % of PV made up."
    )
    return Held(rows, filled, (shares[0], shares[1]), (note,))


def no_common_rate(seconds: FloatArray, stored: Bools) -> TimeError:
    """Error for tags whose times have no rate in common; it leads on by the usual step of PV.

    Parameters
    ----------
    seconds : ndarray, shape (n,)
        Times of the rows.
    stored : ndarray of bool, shape (n,)
        Rows in which PV has a value.
    """
    steps = np.diff(seconds[stored])
    steps = steps[steps > 0]
    if not len(steps):
        return TimeError.expected("several values of PV", "one", "export a longer stretch")
    step = usual_step(steps)
    said = f"steps from {steps.min():.4g} to {steps.max():.4g} s between values of PV"
    error = TimeError.expected("a rate to which all tags can be resampled", said, f"give dt={step:g} to resample them")
    return error.leads_on({"dt": step})


def _last(values: FloatArray, absent: Bools) -> FloatArray:
    """The last value that was stored; missing before the first."""
    place = np.maximum.accumulate(np.where(absent, -1, np.arange(len(values))))
    return np.where(place >= 0, values[np.maximum(place, 0)], np.nan)


def _on_lines(values: FloatArray, absent: Bools) -> FloatArray:
    """On straight lines between the values on either side, where both are there and not far apart."""
    stored = np.flatnonzero(~absent)
    if len(stored) < 2:
        return values
    filled = np.interp(np.arange(len(values)), stored, values[stored], left=np.nan, right=np.nan)
    after = np.minimum(np.searchsorted(stored, np.arange(len(values))), len(stored) - 1)
    width = np.diff(stored, prepend=stored[0])[after]
    return np.where(absent & (width > LONGEST_HOLE), np.nan, filled)
