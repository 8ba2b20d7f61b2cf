"""Blocks from files: saved as such, or as the fit that they are made from."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from lostmotion.arguments import LONGEST, SHORTEST
from lostmotion.compensate.block import CompensatorBlock
from lostmotion.errors import DataError, InputError
from lostmotion.files.fields import Fields
from lostmotion.files.results import read_json
from lostmotion.identify import FitFacts

KEYS = ("kind", "scan_time", "settings")
OTHER_KEYS = ("notes", "accepted")
REMEDY = "use the JSON of a compensating block"
ORIGIN = ("data", "fit", "interval")  # where the settings come from: beside the block in its file, in words
EITHER = "use the JSON of a fit or of a compensating block"


def read_block(path: str | os.PathLike[str]) -> CompensatorBlock:
    """Block from its JSON (``block.to_dict()``, ``lostmotion simulate --block-out``).

    Raises
    ------
    FileAccessError
        The file is not there or not readable.
    DataError
        It is not the JSON of a block.
    """
    return block_of(read_json(path, "a block", REMEDY))


def read_fit_or_block(path: str | os.PathLike[str]) -> FitFacts | CompensatorBlock:
    """What is in the file, a fit or a block; errors as in :func:`read_block` and :func:`lostmotion.read_fit`."""
    data = read_json(path, "a fit or a block", EITHER)
    if "model" in data:
        return FitFacts.from_dict(data)
    if any(key in data for key in KEYS):
        return block_of(data)
    raise DataError.expected("the JSON of a fit or of a block", f"keys {sorted(data)} in {path}", EITHER)


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


def block_of(data: Mapping[str, Any]) -> CompensatorBlock:
    """Block of a dictionary whose types are checked here and whose values by the block itself."""
    saved = Fields(data, "a block", REMEDY)
    saved.require(*KEYS)
    settings = saved.part("settings")
    for name in settings.names:
        settings.number(name)
    saved.text("kind")
    scan_time = saved.number("scan_time")
    if not SHORTEST <= scan_time <= LONGEST:
        raise DataError.expected(f"a scan_time from {SHORTEST:g} to {LONGEST:g} s in a block", scan_time, REMEDY)
    if "notes" in saved:
        saved.texts("notes")
    if "accepted" in saved:
        saved.text("accepted")
    try:
        return CompensatorBlock.from_dict({name: data[name] for name in (*KEYS, *OTHER_KEYS) if name in saved})
    except InputError as error:
        raise DataError.expected("a block that can run", f"one that cannot ({error})", REMEDY) from error
