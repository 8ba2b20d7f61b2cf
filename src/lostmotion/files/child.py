"""Readers in C and Rust that changed bytes can crash: a script for a process of its own; bytes in, plain values out.

Run by :mod:`lostmotion.files.reader_process` as ``python child.py many``: a REQUEST and as many bytes as it says on
standard input, for each the pieces of an answer on standard output, until standard input ends. Every file is read in a
fork of this process, with limits of its own: none meets what another has left, and this process lives on when it dies.
``python child.py one`` reads one file itself and ends. It imports nothing of lostmotion.
"""

from __future__ import annotations

import io
import json
import os
import selectors
import signal
import struct
import sys
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import partial
from importlib import import_module
from typing import IO, Any, NoReturn

import numpy as np

MARK = b"lostmotion leaves 1\n"  # begins every answer
NUMBERS = ("i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f4", "f8")  # types of an answer, little-endian
DEEPEST = 40  # structs in structs
INNER = "#"  # groups of MATLAB's own in HDF5 begin with it
FEWEST_CELLS = (3, 2)  # rows and columns of a sheet with a record
SHEETS, HDF5 = "sheets", "hdf5"  # kinds: a workbook, a MAT file of version 7.3
PARQUET, FEATHER, PIECES = "parquet", "feather", "pieces"  # on trial: read here first, and not handed over
PACKAGES = {SHEETS: ("fastexcel", "polars"), HDF5: ("h5py",)} | dict.fromkeys((PARQUET, FEATHER, PIECES), ("polars",))
MANY, ONE = "many", "one"  # files of this process
REQUEST = struct.Struct("<16sQQQ")  # kind, bytes of memory, seconds of work, bytes of the file
SIZE, CODE = struct.Struct("<Q"), struct.Struct("<i")  # before each message: pieces of an answer, none, exit code
PIECE = 1 << 20


def answer(kind: str, raw: bytes) -> bytes:
    """Mark, length of a JSON text, the text, and the bytes that it tells of.

    Parameters
    ----------
    kind : str
        SHEETS, HDF5, PARQUET, FEATHER or PIECES.
    raw : bytes
        Content of the file; of PIECES their paths, in JSON.

    Notes
    -----
    The text is ``{"leaves": [[path, type, value], ..]}`` or ``{"error": reason}``. Types: one of NUMBERS, "bool" or
    "bytes", with the count; "text" and "texts" with the value itself; "other", which is no signal.
    """
    try:
        leaves = list(READERS[kind](raw))
    except MemoryError:
        return _packed({"error": "memory"})
    except BaseException as error:  # noqa: BLE001  whatever the damaged bytes lead to; a panic of Rust is no Exception
        said = str(error).strip().split("\n", maxsplit=1)[0]
        return _packed({"error": f"{type(error).__name__}: {said}"[:300]})
    told, data = [], []
    for path, value in leaves:
        name, detail, numbers = _leaf(value)
        told.append([_clean(path), name, detail])
        data.append(numbers)
    return _packed({"leaves": told}, *data)


def _packed(told: Mapping[str, Any], *numbers: bytes) -> bytes:
    text = json.dumps(told).encode()
    return b"".join([MARK, struct.pack("<Q", len(text)), text, *numbers])


def _leaf(value: Any) -> tuple[str, Any, bytes]:
    if isinstance(value, bytes):
        return "bytes", len(value), value
    if isinstance(value, str):
        return "text", _clean(value), b""
    array = np.asarray(value)
    column = array.ndim == 1 or array.size == 1
    if column and array.dtype.kind == "b":
        return "bool", array.size, array.astype("u1").tobytes()
    if column and array.dtype.kind in "iuf":
        fits = array.dtype.kind + str(array.dtype.itemsize)
        name = fits if fits in NUMBERS else "f8"
        return name, array.size, array.astype(f"<{name}").tobytes()
    if array.ndim == 1 and (array.dtype.kind == "U" or all(isinstance(cell, str) for cell in array)):
        return "texts", [_clean(str(cell)) for cell in array], b""
    return "other", None, b""


def _clean(text: str) -> str:
    """Text without halves of characters, which no table can hold."""
    return text.encode("utf-8", "replace").decode()


def _of_workbook(raw: bytes) -> Iterator[tuple[str, bytes]]:
    """Name of each sheet, and its cells as text with tabs, without the rows and columns that are empty."""
    import fastexcel  # noqa: PLC0415
    import polars as pl  # noqa: PLC0415

    reader = fastexcel.read_excel(raw)
    for name in reader.sheet_names:
        sheet = reader.load_sheet(name, header_row=None, dtypes="string").to_polars()
        sheet = sheet.select([column for column in sheet.columns if sheet[column].is_not_null().any()])
        if sheet.width:
            sheet = sheet.filter(pl.any_horizontal(pl.all().is_not_null()))
        if sheet.height >= FEWEST_CELLS[0] and sheet.width >= FEWEST_CELLS[1]:
            yield name, sheet.write_csv(separator="\t", include_header=False).encode()


def _trial(kind: str, raw: bytes) -> Iterator[tuple[str, Any]]:
    """No leaves: that it comes to an end is the answer."""
    import polars as pl  # noqa: PLC0415

    if kind == PIECES:
        pl.read_parquet(json.loads(raw), hive_partitioning=True, glob=False)
    else:
        (pl.read_parquet if kind == PARQUET else pl.read_ipc)(raw)
    yield from ()


def _need_shallow(depth: int) -> None:
    if depth > DEEPEST:
        raise ValueError(f"structs deeper than {DEEPEST}")


def _of_hdf5(raw: bytes) -> Iterator[tuple[str, Any]]:
    """Leaves of version 7.3.

    Notes
    -----
    MATLAB writes a struct as a group, a vector as a matrix of one row or column, text as 16-bit numbers with the
    attribute MATLAB_class = char, and cells and arrays of structs as references.
    """
    import h5py  # noqa: PLC0415

    with h5py.File(io.BytesIO(raw), "r") as file:
        yield from _members(file, file, "")


def _members(file: Any, group: Any, above: str, depth: int = 0) -> Iterator[tuple[str, Any]]:
    _need_shallow(depth)
    for name, item in _own(group):
        if not hasattr(item, "dtype"):
            yield from _struct(file, item, f"{above}{name}", depth + 1)
        elif item.dtype.hasobject and _class(item) != "cell":  # an array of structs that has no group
            for place, one in enumerate(_referred(file, item)):
                yield from _any(file, one, f"{above}{name}({place + 1})", depth + 1)
        else:
            yield f"{above}{name}", _value(file, item)


def _own(group: Any) -> list[tuple[str, Any]]:
    """Members by their names; a link that is no hard one may lead into another file."""
    hard = [name for name in group if type(group.get(name, getlink=True)).__name__ == "HardLink"]
    return [(name, group[name]) for name in hard if not name.startswith(INNER)]


def _struct(file: Any, group: Any, path: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Fields of a struct; of an array of structs, whose fields are references, those of each."""
    inside = _own(group)
    fields = {name: item for name, item in inside if hasattr(item, "dtype")}
    several = [item for item in fields.values() if item.dtype.hasobject and _class(item) != "cell"]
    if not several or len(several) < len(inside):
        yield from _members(file, group, f"{path}.", depth)
        return
    for name, item in fields.items():
        for place, one in enumerate(_referred(file, item)):
            yield from _any(file, one, f"{path}({place + 1}).{name}", depth)


def _any(file: Any, item: Any, path: str, depth: int) -> Iterator[tuple[str, Any]]:
    if hasattr(item, "dtype"):
        yield path, _value(file, item)
    else:
        yield from _members(file, item, f"{path}.", depth)


def _referred(file: Any, item: Any) -> list[Any]:
    _need_own(item)
    return [file[one] for one in np.asarray(item).ravel(order="F")]


def _need_own(item: Any) -> None:
    if item.external or item.is_virtual:
        raise ValueError("numbers that are in another file")


def _value(file: Any, item: Any, depth: int = 0) -> Any:
    """Numbers as an array without dimensions of one, text as text, a cell of texts as an array of them."""
    _need_shallow(depth)
    _need_own(item)
    if item.attrs.get("MATLAB_empty", 0):
        return "" if _class(item) == "char" else np.zeros(0)
    if item.dtype.hasobject:
        inside = [_value(file, one, depth + 1) for one in _referred(file, item)]
        made = np.empty(len(inside), dtype=object)
        made[:] = inside
        return made
    values = np.asarray(item)
    if _class(item) == "char":
        return "".join(chr(code) for code in values.ravel(order="F"))
    return np.squeeze(values.T)


def _class(item: Any) -> str:
    said = item.attrs.get("MATLAB_class", b"")
    return said.decode() if isinstance(said, bytes) else str(said)


READERS = {SHEETS: _of_workbook, HDF5: _of_hdf5} | {kind: partial(_trial, kind) for kind in (PARQUET, FEATHER, PIECES)}


def limit(memory: int, seconds: int) -> None:
    """Limits of this process, where the system has them: bytes, seconds of work, and no file written."""
    if sys.platform == "win32":
        return
    import resource  # noqa: PLC0415  not on Windows

    limits = {
        resource.RLIMIT_AS: memory,
        resource.RLIMIT_CPU: seconds,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_FSIZE: 0,
    }
    for what, most in limits.items():
        hard = resource.getrlimit(what)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (least, hard))


def exactly(stream: IO[bytes], size: int) -> bytes:
    """So many bytes.

    Raises
    ------
    EOFError
        There are fewer.
    """
    pieces = []
    while size:
        piece = stream.read(min(size, PIECE))
        if not piece:
            raise EOFError
        pieces.append(piece)
        size -= len(piece)
    return pieces[0] if len(pieces) == 1 else b"".join(pieces)


def _forked(kind: str, raw: bytes, memory: int, seconds: int, out: IO[bytes]) -> int:
    """Exit code of the reader in a fork, whose answer is passed on as it comes."""
    if sys.platform == "win32":
        raise NotImplementedError("no forks on Windows")
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        _reader(kind, raw, memory, seconds, writing)
    os.close(writing)
    with selectors.DefaultSelector() as waits:
        waits.register(reading, selectors.EVENT_READ)
        waits.register(0, selectors.EVENT_READ)
        while True:
            if any(key.fd == 0 for key, _ in waits.select()):  # nothing is to come but the end of who asks
                os.kill(child, signal.SIGKILL)
                os._exit(0)
            piece = os.read(reading, PIECE)
            if not piece:
                break
            out.write(SIZE.pack(len(piece)) + piece)
    os.close(reading)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


def _reader(kind: str, raw: bytes, memory: int, seconds: int, writing: int) -> NoReturn:
    """Life of a fork: it reaches nothing but its answer."""
    try:
        nowhere = os.open(os.devnull, os.O_RDWR)
        os.dup2(nowhere, 0)
        os.dup2(nowhere, 1)
        limit(memory, seconds)
        with open(writing, "wb") as out:
            out.write(answer(kind, raw))
        os._exit(0)
    finally:
        os._exit(1)


def _loaded(kind: str) -> None:
    """Packages that a reader needs, before the fork; what is wrong with them is said behind it."""
    for package in PACKAGES.get(kind, ()):
        with suppress(Exception):
            import_module(package)


def serve(how: str, requests: IO[bytes], out: IO[bytes]) -> None:
    """Answer until there is no more request, or one."""
    while head := requests.read(REQUEST.size):
        name, memory, seconds, size = REQUEST.unpack(head)
        kind, raw = name.rstrip(b"\0").decode(), exactly(requests, size)
        if how == MANY:
            _loaded(kind)
            code = _forked(kind, raw, memory, seconds, out)
        else:
            limit(memory, seconds)
            found, code = answer(kind, raw), 0
            for first in range(0, len(found), PIECE):
                piece = found[first : first + PIECE]
                out.write(SIZE.pack(len(piece)) + piece)
        out.write(SIZE.pack(0) + SIZE.pack(CODE.size) + CODE.pack(code))
        out.flush()
        if how == ONE:
            return


if __name__ == "__main__":
    serve(sys.argv[1], sys.stdin.buffer, sys.stdout.buffer)
