"""MATLAB files -> dotted path and value of each variable -> a table for each loop."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np

from lostmotion.errors import DataError
from lostmotion.files.structs import tables_of_structs
from lostmotion.files.table import Table

MAT = b"MATLAB 5.0 MAT-file"  # written by save -v6 and -v7
MAT_HDF5 = b"MATLAB 7.3 MAT-file"


def load_mat(raw: bytes, source: str) -> dict[str, Table]:
    """Tables of a MAT file by the name of the loop; under "" where there is one.

    Parameters
    ----------
    raw : bytes
        Content of a file of version 5 (``save -v7`` or ``-v6``) or of version 7.3.
    source : str
        Name of the file, for messages.

    Raises
    ------
    DataError
        A damaged file, one without vectors, or one of version 7.3 where its reader is not installed.
    """
    if raw.startswith(MAT_HDF5):
        from lostmotion.files.matlab_hdf5 import leaves_of_hdf5  # noqa: PLC0415  only files of version 7.3 need it

        return tables_of_structs(leaves_of_hdf5(raw, source), source)
    from scipy.io import loadmat  # noqa: PLC0415  a quarter of a second that text files need not wait for

    try:
        content = loadmat(io.BytesIO(raw), squeeze_me=True)  # type: ignore[arg-type]
    except Exception as error:  # scipy raises whatever the damaged bytes lead to
        reason = f"{type(error).__name__}: {error}"
        raise DataError.expected(
            "a whole MAT file", f"a damaged one, {source!r} ({reason})", "save it again"
        ) from error
    variables = {name: value for name, value in content.items() if not name.startswith("__")}
    return tables_of_structs(_leaves(variables), source)


def _leaves(variables: dict[str, Any], above: str = "") -> Iterator[tuple[str, Any]]:
    """Dotted path and value of every variable that is no struct."""
    for name, value in variables.items():
        array = np.asarray(value)
        if array.dtype.names and array.ndim == 0:
            yield from _leaves({field: array[field].item() for field in array.dtype.names}, f"{above}{name}.")
        elif array.dtype.names:
            for place, one in enumerate(array.ravel()):
                inside = {field: one[field] for field in array.dtype.names}
                yield from _leaves(inside, f"{above}{name}({place + 1}).")
        else:
            yield f"{above}{name}", value
