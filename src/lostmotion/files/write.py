"""Columns -> CSV or Parquet, whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import narwhals.stable.v2 as nw
import numpy as np
import numpy.typing as npt
import polars as pl

from lostmotion.errors import DataError, FileAccessError, InputError, ParameterError
from lostmotion.files.writer import refuse, write_bytes
from lostmotion.printable import cell_of

_SEPARATORS = {".csv": ",", ".txt": "\t", ".tsv": "\t"}
_PARQUET = (".parquet", ".pq")


def write_columns(path: str | os.PathLike[str], columns: Mapping[str, npt.ArrayLike], force: bool = False) -> Path:
    """Write arrays of one length as a table, see :func:`write_table`.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = write_columns(Path(folder) / "a.csv", {"OP": [1.0, np.nan], "PV": [3.0, 4.5]})
    ...     path.read_text().split()
    ['OP,PV', '1.0,3.0', ',4.5']
    """
    arrays = {name: np.asarray(values) for name, values in columns.items()}
    shapes = {name: array.shape for name, array in arrays.items()}
    if not arrays or len(set(shapes.values())) != 1 or len(next(iter(shapes.values()))) != 1:
        raise DataError.expected(
            "columns of one length", f"shapes {shapes}", "cut them to the same rows before writing"
        )
    return write_table(path, pl.DataFrame(arrays), force)


def write_table(path: str | os.PathLike[str], columns: Any, force: bool = False) -> Path:
    """Write a table in one step: another reader sees the old file or the new one, never half of it.

    Parameters
    ----------
    path : path
        Suffix .csv (comma), .txt or .tsv (tab), .parquet or .pq.
    columns : mapping or data frame
        Mapping of names to arrays, or an eager pandas, Polars or PyArrow frame. NaN becomes an empty cell
        in text.
    force : bool
        Replace a file that is already there.

    Returns
    -------
    Path
        What was written.

    Raises
    ------
    FileAccessError
        The file exists and `force` is False, or the folder cannot be written.
    ParameterError
        Another suffix.
    DataError
        Columns of different lengths.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = write_table(Path(folder) / "a.parquet", pl.DataFrame({"OP": [1.0, 2.0]}))
    ...     write_table(path, pl.DataFrame({"OP": [3.0]}), force=True).name
    'a.parquet'
    """
    if isinstance(columns, Mapping):
        return write_columns(path, columns, force)
    target = Path(path)
    suffix = known_format(target)
    refuse(target, force)
    frame, stream = _polars(columns), BytesIO()
    try:
        if suffix in _PARQUET:
            frame.write_parquet(stream)
        else:
            _without_formulas(frame).fill_nan(None).write_csv(stream, separator=_SEPARATORS[suffix])
    except (OSError, pl.exceptions.PolarsError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        remedy = f"columns of numbers, or text as {', '.join(_SEPARATORS)}"
        raise FileAccessError(f"expected a table that {suffix} can hold, got {reason!r}; give {remedy}") from error
    return write_bytes(target, stream.getbuffer(), force)


def _without_formulas(frame: pl.DataFrame) -> pl.DataFrame:
    """Texts and names of columns that no spreadsheet takes for a formula."""
    texts = pl.col(pl.String).map_elements(cell_of, return_dtype=pl.String)
    return frame.with_columns(texts).rename({name: cell_of(name) for name in frame.columns})


def known_format(path: Path) -> str:
    """Suffix of a table, in lower case.

    Raises
    ------
    ParameterError
        Another suffix.
    """
    suffix = path.suffix.lower()
    if suffix not in (*_SEPARATORS, *_PARQUET):
        raise ParameterError.expected(
            f"a name that ends with one of {[*_SEPARATORS, *_PARQUET]}",
            repr(path.name),
            "choose the format by the suffix",
        )
    return suffix


def _polars(columns: Any) -> pl.DataFrame:
    if isinstance(columns, pl.DataFrame):
        return columns
    try:
        frame = nw.from_native(columns, eager_only=True)
    except TypeError as error:
        raise InputError.expected(
            "a mapping of names to arrays or an eager data frame", type(columns).__name__, "convert it first"
        ) from error
    return pl.DataFrame({name: frame[name].to_list() for name in frame.columns})
