"""Results as JSON files."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError, FileAccessError
from lostmotion.files.paths import is_folder, is_other
from lostmotion.files.schema import parsed
from lostmotion.files.writer import write_bytes

MOST_JSON = 1 << 26  # bytes: a fit has some 10 KiB


def write_text(path: str | os.PathLike[str], text: str, force: bool = False) -> Path:
    """Write a text file whole or not at all; errors as in :func:`lostmotion.files.writer.write_bytes`."""
    return write_bytes(path, text.encode("utf-8"), force)


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
    if is_folder(source) or is_other(source):
        raise FileAccessError(f"expected a file with {what}, got {source}, which is none; give a regular file")
    try:
        with source.open("rb") as stream:
            data = parsed(stream.read(MOST_JSON + 1), MOST_JSON)
    except OSError as error:
        raise FileAccessError(f"expected a readable {source}, got {error.strerror}; check the path") from error
    except ValueError as error:
        raise DataError.expected(f"the JSON of {what}", f"{source}: {str(error)[:200]}", remedy) from error
    if not isinstance(data, dict):
        raise DataError.expected(f"the JSON of {what}", f"other JSON in {source}", remedy)
    return data
