"""An archive of several files (.zip, .tar, .tar.gz) -> what stands in each, as in a folder."""

from __future__ import annotations

import gzip
import io
import tarfile
import zipfile
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PurePosixPath
from typing import IO

from lostmotion.errors import DataError, LostMotionError
from lostmotion.files.frames import read_bytes
from lostmotion.files.gathered import ENDINGS
from lostmotion.files.limits import most_bytes
from lostmotion.files.packed import GZIP, WORKBOOK, ZIP, content_of, unpacked
from lostmotion.files.paths import is_file
from lostmotion.files.undamaged import undamaged

TAR = b"ustar"
AT = 257  # bytes before it
HEAD = 512
BESIDE = ("readme", "license", "licence")  # files that are no data
Files = list[tuple[Path, bytes]]


def archived(path: Path) -> Files:
    """Files of data in an archive of several, in the order of their names; empty for any other file.

    Raises
    ------
    FileAccessError
        Not readable.
    DataError
        Damaged, without a file of data, or larger unpacked than a file may be.
    """
    kind = _kind(path)
    if not kind:
        return []
    raw = read_bytes(path)
    with undamaged("a whole archive", path.name, "pack it again", quiet=False):
        return sorted(_zipped(raw, path.name) if kind == "zip" else _tarred(raw, path.name))


def _kind(path: Path) -> str:
    """Zip of several files, or tar; empty for any other file."""
    start, inside = b"", b""
    if not is_file(path):  # a pipe would wait for whoever writes into it
        return ""
    with suppress(LostMotionError), undamaged("an archive", path.name, "pack it again", quiet=False):
        with path.open("rb") as stream:
            start = inside = stream.read(HEAD)
        if start.startswith(ZIP):
            with zipfile.ZipFile(path) as archive:
                names = [one.filename for one in archive.infolist() if not one.is_dir()]
            several = len([name for name in names if not name.startswith("__MACOSX/")]) > 1
            return "zip" if several and not any(name.startswith(WORKBOOK) for name in names) else ""
        if start.startswith(GZIP):
            with gzip.open(path) as packed:
                inside = packed.read(HEAD)
    return "tar" if inside[AT:].startswith(TAR) else ""


def _zipped(raw: bytes, name: str) -> Files:
    with zipfile.ZipFile(io.BytesIO(raw)) as archive:
        members = {one.filename: one for one in archive.infolist() if not one.is_dir()}
        places = _of_data(members, name)
        return list(_read(((place, archive.open(members[place])) for place in places), name))


def _tarred(raw: bytes, name: str) -> Files:
    with tarfile.open(fileobj=io.BytesIO(unpacked(raw, name)[0]), mode="r:") as archive:
        members = {one.name: one for one in archive.getmembers() if one.isfile()}
        streams = ((place, archive.extractfile(members[place])) for place in _of_data(members, name))
        return list(_read(((place, stream) for place, stream in streams if stream is not None), name))


def _read(streams: Iterator[tuple[str, IO[bytes]]], name: str) -> Iterator[tuple[Path, bytes]]:
    """Content of each; one that says it is small may be large. All together have the room of one file."""
    room = most_bytes()
    for place, stream in streams:
        with stream:
            content = content_of(stream, name, most=room)
        room -= len(content)
        yield Path(*PurePosixPath(place).parts), content


def _of_data(names: dict[str, zipfile.ZipInfo] | dict[str, tarfile.TarInfo], name: str) -> list[str]:
    """Members with an ending of data, hidden ones and descriptions left out."""
    kept = [one for one in names if _is_data(PurePosixPath(one))]
    if not kept:
        listed = ", ".join(list(names)[:4]) or "none"
        raise DataError.expected(f"files with tables in {name!r}", listed, f"pack such as end in {', '.join(ENDINGS)}")
    return kept


def _is_data(place: PurePosixPath) -> bool:
    hidden = any(part.startswith((".", "__MACOSX")) for part in place.parts)
    return not hidden and place.suffix.lower() in ENDINGS and not place.stem.lower().startswith(BESIDE)
