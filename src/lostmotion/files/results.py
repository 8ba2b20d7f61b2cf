"""Results as JSON files."""

from __future__ import annotations

import json
import os
import secrets
from pathlib import Path
from typing import Any, BinaryIO

from lostmotion.errors import DataError, FileAccessError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def write_text(path: str | os.PathLike[str], text: str, force: bool = False) -> Path:
    """Write a text file whole or not at all.

    Raises
    ------
    FileAccessError
        The file exists and `force` is not set, or the folder cannot be written.
    """
    target = Path(path)
    if target.exists() and not force:
        raise FileAccessError(f"expected a new file, got {target} which exists; use --force to replace it")
    return write_bytes(target, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> Path:
    """Replace a file in one step: after a crash or a power cut it is the old one or the new one.

    Raises
    ------
    FileAccessError
        The folder cannot be written.
    """
    beside = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        with beside.open("xb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise FileAccessError(f"expected to write {path}, got {error.strerror}; check the folder") from error
    return path


def lock_file(path: Path) -> BinaryIO | None:
    """Keep other processes of lostmotion from working with `path` until what is returned is closed, or we end.

    None where the platform has no such locks.

    Raises
    ------
    FileAccessError
        Another process works with it, or the folder cannot be written.
    """
    if fcntl is None:
        return None
    beside = path.with_name(f".{path.name}.lock")
    try:
        stream = beside.open("ab")
    except OSError as error:
        raise FileAccessError(f"expected to write {beside}, got {error.strerror}; check the folder") from error
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        stream.close()
        raise FileAccessError(f"expected {path} for this process alone, got another one that works with it") from error
    return stream


def write_json(path: str | os.PathLike[str], data: Any, force: bool = False) -> Path:
    """Write a result as JSON whole or not at all; errors as in :func:`write_text`."""
    return write_text(path, json.dumps(data, indent=2, allow_nan=False) + "\n", force)


def read_json(path: str | os.PathLike[str], what: str, remedy: str) -> dict[str, Any]:
    """Dictionary in a JSON file.

    Parameters
    ----------
    path : path
    what, remedy : str
        For messages: what should be in the file ("a fit") and how to get it.

    Raises
    ------
    FileAccessError
        The file is not there or not readable.
    DataError
        It is no JSON, or JSON of something else than a dictionary.
    """
    source = Path(path)
    try:
        data = json.loads(source.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileAccessError(f"expected a readable {source}, got {error.strerror}; check the path") from error
    except (ValueError, RecursionError) as error:
        raise DataError.expected(f"the JSON of {what}", f"{source}: {error}", remedy) from error
    if not isinstance(data, dict):
        raise DataError.expected(f"the JSON of {what}", f"other JSON in {source}", remedy)
    return data
