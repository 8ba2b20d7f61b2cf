"""Bytes of a file -> bytes of what is packed in it: gzip, or a zip archive of one file."""

from __future__ import annotations

import gzip
import io
import zipfile
from typing import IO

from lostmotion.errors import DataError
from lostmotion.files.limits import most_bytes, too_large
from lostmotion.files.undamaged import undamaged
from lostmotion.files.watch import LONG, tell

GZIP = b"\x1f\x8b"
ZIP = b"PK\x03\x04"
WORKBOOK = "xl/workbook"
PIECE = 1 << 20  # bytes


def unpacked(raw: bytes, name: str) -> tuple[bytes, str]:
    """Content and name of what a file holds; the file itself where nothing is packed, or where it is a workbook.

    Raises
    ------
    DataError
        Damaged, several files in the archive, or larger unpacked than a file may be.

    Examples
    --------
    >>> unpacked(gzip.compress(b"OP,PV"), "FIC-1.csv.gz")
    (b'OP,PV', 'FIC-1.csv')
    """
    with undamaged("a whole archive", name, "pack it again", quiet=False):
        if raw.startswith(GZIP):
            packed = io.BytesIO(raw)
            with gzip.GzipFile(fileobj=packed) as stream:
                return content_of(stream, name, packed), name.removesuffix(".gz")
        if raw.startswith(ZIP):
            return _from_zip(raw, name)
    return raw, name


def is_workbook(raw: bytes) -> bool:
    """Whether the bytes are those of a spreadsheet (.xlsx, .xlsm, .xlsb or .xls)."""
    if raw.startswith(b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"):
        return True
    if not raw.startswith(ZIP):
        return False
    with undamaged("a whole archive", "it", "pack it again", quiet=False), zipfile.ZipFile(io.BytesIO(raw)) as archive:
        return any(member.startswith(WORKBOOK) for member in archive.namelist())


def _from_zip(raw: bytes, name: str) -> tuple[bytes, str]:
    with zipfile.ZipFile(io.BytesIO(raw)) as archive:
        members = [one for one in archive.infolist() if not one.is_dir() and not one.filename.startswith("__MACOSX/")]
        if any(one.filename.startswith(WORKBOOK) for one in members):
            return raw, name
        if len(members) != 1:
            listed = ", ".join(one.filename for one in members[:4]) or "none"
            raise DataError.expected(
                f"one file in {name!r}", f"{len(members)}: {listed}", "unpack it and give one file"
            )
        with archive.open(members[0]) as stream:
            return content_of(stream, name), members[0].filename


def content_of(
    stream: IO[bytes] | gzip.GzipFile, name: str, packed: io.BytesIO | None = None, most: int | None = None
) -> bytes:
    """All of a stream: piece by piece, since one read of an unknown size takes the room that it might need at once.

    `packed`, where it is known, tells how far it is; `most` bytes are taken, None: those of a file.

    Raises
    ------
    DataError
        It is larger than a file may be.
    """
    whole, most = io.BytesIO(), most_bytes() if most is None else most
    while piece := stream.read(PIECE):
        whole.write(piece)
        if packed is not None and whole.tell() > LONG:
            tell(f"unpacking {name}", packed.tell(), packed.getbuffer().nbytes)
        if whole.tell() > most:
            raise too_large(repr(name))
    return whole.getvalue()
