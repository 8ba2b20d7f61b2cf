"""MAT files of version 7.3, which are HDF5: dotted path and value of each variable."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from lostmotion.errors import DataError

INNER = "#"  # groups of MATLAB's own begin with it


def leaves_of_hdf5(raw: bytes, source: str) -> list[tuple[str, Any]]:
    """Dotted path and value of every variable that is no struct.

    Parameters
    ----------
    raw : bytes
        Content of the file.
    source : str
        Its name, for messages.

    Raises
    ------
    DataError
        Damaged, or h5py is not installed.

    Notes
    -----
    MATLAB writes a struct as a group, a vector as a matrix of one row or column, text as 16-bit numbers with the
    attribute MATLAB_class = char, and cells and arrays of structs as references.
    """
    try:
        import h5py  # noqa: PLC0415  only files of version 7.3 need it
    except ImportError as error:
        raise DataError.expected(
            f"the reader of MAT files of version 7.3 for {source!r}",
            "none",
            "install lostmotion[matlab], or save it with save(.., '-v7')",
        ) from error
    try:
        with h5py.File(io.BytesIO(raw), "r") as file:
            return list(_leaves(file, file, ""))
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:  # what HDF5 makes of damaged bytes
        raise DataError.expected("a whole MAT file", f"a damaged one, {source!r} ({error})", "save it again") from error


def _leaves(file: Any, group: Mapping[str, Any], above: str) -> Iterator[tuple[str, Any]]:
    for name, item in group.items():
        if name.startswith(INNER):
            continue
        if not hasattr(item, "dtype"):
            yield from _struct(file, item, f"{above}{name}")
        elif item.dtype.hasobject and _class(item) != "cell":  # an array of structs that has no group
            for place, one in enumerate(_referred(file, item)):
                yield from _any(file, one, f"{above}{name}({place + 1})")
        else:
            yield f"{above}{name}", _value(file, item)


def _struct(file: Any, group: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Fields of a struct; of an array of structs, whose fields are references, those of each."""
    fields = {name: item for name, item in group.items() if hasattr(item, "dtype")}
    several = [item for item in fields.values() if item.dtype.hasobject and _class(item) != "cell"]
    if not several or len(several) < len(group):
        yield from _leaves(file, group, f"{path}.")
        return
    for name, item in fields.items():
        for place, one in enumerate(_referred(file, item)):
            yield from _any(file, one, f"{path}({place + 1}).{name}")


def _any(file: Any, item: Any, path: str) -> Iterator[tuple[str, Any]]:
    if hasattr(item, "dtype"):
        yield path, _value(file, item)
    else:
        yield from _leaves(file, item, f"{path}.")


def _referred(file: Any, item: Any) -> list[Any]:
    return [file[one] for one in np.asarray(item).ravel(order="F")]


def _value(file: Any, item: Any) -> Any:
    """Numbers as an array without dimensions of one, text as text, a cell of texts as an array of them."""
    if item.attrs.get("MATLAB_empty", 0):
        return "" if _class(item) == "char" else np.zeros(0)
    if item.dtype.hasobject:
        return np.array([_value(file, one) for one in _referred(file, item)], dtype=object)
    values = np.asarray(item)
    if _class(item) == "char":
        return "".join(chr(code) for code in values.ravel(order="F"))
    return np.squeeze(values.T)


def _class(item: Any) -> str:
    said = item.attrs.get("MATLAB_class", b"")
    return said.decode() if isinstance(said, bytes) else str(said)
