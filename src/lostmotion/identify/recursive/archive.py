"""Arrays as bytes and back; bytes that are something else are refused."""

from __future__ import annotations

import io
import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.errors import DataError

# What NumPy and zipfile raise on a damaged archive (RuntimeError: a flipped bit says that it is encrypted; TokenError,
# SyntaxError: in the header of an array), and what the reader of its arrays finds missing or of the wrong kind
BROKEN = (
    ArithmeticError, ValueError, TypeError, KeyError, IndexError, AttributeError, OSError, EOFError, RuntimeError,
    SyntaxError, MemoryError, struct.error, tokenize.TokenError, zipfile.BadZipFile, zlib.error,
)  # fmt: skip


def pack(**arrays: Any) -> bytes:
    """Archive of the arrays; equal arrays give equal bytes."""
    buffer = io.BytesIO()
    np.savez(buffer, **arrays)
    return buffer.getvalue()


@contextmanager
def reading(data: bytes) -> Iterator[dict[str, npt.NDArray[Any]]]:
    """Arrays by name; whatever is found wrong with them inside is a DataError, ParameterError included."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            if sum(member.file_size for member in archive.infolist()) > len(data):
                raise ValueError("packed")  # ours are not, and a packed one may unpack to any size
        with np.load(io.BytesIO(data), allow_pickle=False) as stored:
            arrays = {name: stored[name] for name in stored.files}
        yield arrays
    except BROKEN as error:
        raise DataError.expected("the bytes of to_bytes()", f"{len(data)} other bytes", "save it again") from error
