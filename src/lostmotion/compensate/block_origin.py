"""Where the settings of a saved block come from: beside the block in its file, in words."""

from __future__ import annotations

import os

from lostmotion.compensate.saved_block import REMEDY
from lostmotion.files.fields import Fields
from lostmotion.files.results import read_json

ORIGIN = ("data", "fit", "interval")


def read_origin(path: str | os.PathLike[str]) -> dict[str, str]:
    """Where the settings of a saved block come from; empty in older files, and of a block without a fit.

    Raises
    ------
    FileAccessError
        The file is not there or not readable.
    DataError
        What is said of it is no text.
    """
    saved = Fields(read_json(path, "a block", REMEDY), "a block", REMEDY)
    if "origin" not in saved:
        return {}
    origin = saved.part("origin")
    return {name: origin.text(name) for name in ORIGIN if name in origin}
