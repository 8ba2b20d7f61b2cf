"""Mapping of columns, ``{"OP": .., "PV": ..}`` -> Polars frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import polars as pl

from lostmotion.errors import DataError


def frame_of(columns: Mapping[Any, Any]) -> pl.DataFrame:
    """Table of a mapping of names to lists, arrays or series.

    Raises
    ------
    DataError
        No column, names that are no text, or columns of other shape or length than one value a row.

    Examples
    --------
    >>> frame_of({"OP": [1, 2], "PV": np.array([3.0, 4.0])}).shape
    (2, 2)
    """
    wrong = [name for name in columns if not isinstance(name, str)]
    if wrong or not columns:
        raise DataError.expected("columns by their names, as {'OP': .., 'PV': ..}", wrong or "none", "give OP and PV")
    table = [_column(name, values) for name, values in columns.items()]
    if len({len(one) for one in table}) > 1:
        got = ", ".join(f"{one.name} {len(one)}" for one in table)
        raise DataError.expected("columns of one length", got, "cut all to the same rows")
    return pl.DataFrame(table)


def _column(name: str, values: Any) -> pl.Series:
    if isinstance(values, pl.Series):
        return values.alias(name)
    array = values if isinstance(values, list | tuple | range) else np.asarray(values)
    if isinstance(array, np.ndarray) and array.dtype.kind == "M":
        array = array.astype("M8[us]")  # Polars knows no seconds
    if isinstance(array, np.ndarray) and array.ndim != 1:
        got = f"{type(values).__name__} of shape {array.shape}" if array.ndim else repr(values)
        raise DataError.expected(f"{name} with one value a row", got, "give a list or an array")
    try:
        return pl.Series(name, array, strict=False)
    except (TypeError, ValueError, pl.exceptions.PolarsError) as error:
        raise DataError.expected(f"{name} with one value a row", type(error).__name__, "give numbers") from error
