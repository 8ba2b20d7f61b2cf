"""A header in JSON and a blob in one piece of bytes that tells whether it is whole."""

from __future__ import annotations

import hashlib
import json
import struct
from typing import Any

from lostmotion.errors import DataError
from lostmotion.files.schema import checked, kept, parsed

STATE = "lostmotion online state 1"  # kind of the file of `--state`
_CHECK = 32  # bytes of the hash at the end


def pack(kind: str, header: dict[str, Any], blob: bytes) -> bytes:
    """Join a header and a blob.

    Examples
    --------
    >>> unpack("a 1", pack("a 1", {"n": 3}, b"xyz"))
    ({'n': 3}, b'xyz')
    """
    text = json.dumps(header, allow_nan=False).encode()
    body = kind.encode() + b"\n" + struct.pack("<Q", len(text)) + text + blob
    return body + hashlib.sha256(body).digest()


def unpack(kind: str, data: bytes) -> tuple[dict[str, Any], bytes]:
    """Header and blob of :func:`pack`.

    Raises
    ------
    DataError
        Other bytes, another version, or damaged ones.
    """
    start = kind.encode() + b"\n"
    if not data.startswith(start):
        raise DataError.expected(f"the bytes of a {kind!r}", f"{data[:24]!r}..", "start anew, or give the right file")
    if len(data) < len(start) + 8 + _CHECK or hashlib.sha256(data[:-_CHECK]).digest() != data[-_CHECK:]:
        raise DataError.expected(f"a whole {kind!r}", "a damaged one", "start anew, or take a backup")
    (length,) = struct.unpack_from("<Q", data, len(start))
    begin = len(start) + 8
    stop = begin + length
    if stop > len(data) - _CHECK:
        raise DataError.expected(f"a whole {kind!r}", "a header that is longer than the rest", "take a backup")
    try:
        header = parsed(data[begin:stop])
    except ValueError as error:
        raise DataError.expected(f"a header in {kind!r}", str(error)[:100], "start anew, or take a backup") from error
    return checked(header, kept("a group", lambda value: isinstance(value, dict)), kind, "take a backup"), data[
        stop:-_CHECK
    ]
