"""Whatever holds a record -> LoopRecord: the one door for functions that take records, files and frames alike."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lostmotion.files.gathered import holds_one_tag
from lostmotion.files.paths import is_path
from lostmotion.files.read import read_loop
from lostmotion.records.record import LoopRecord


def is_source(value: Any) -> bool:
    """Whether a value is a path or a data frame, and no array of samples.

    Examples
    --------
    >>> is_source("FIC-101.csv"), is_source([1.0, 2.0])
    (True, False)
    """
    return is_path(value) or (hasattr(value, "columns") and not isinstance(value, LoopRecord))


def as_record(source: Any, **settings: Any) -> LoopRecord:
    """Record as it is; a path or a data frame is read.

    Parameters
    ----------
    source : LoopRecord, path or data frame
    **settings
        Those of :func:`lostmotion.read_loop`, for a path or a frame.

    Raises
    ------
    LostMotionError
        As in read_loop.

    Examples
    --------
    >>> import polars as pl
    >>> as_record(pl.DataFrame({"t_s": [0, 1, 2], "OP": [1, 2, 3], "PV": [3, 2, 1]}))
    LoopRecord('': 3 samples of OP, PV every 1 s, 3 s)
    """
    return source if isinstance(source, LoopRecord) else read_loop(source, **settings)


def as_records(source: Any, **settings: Any) -> Any:
    """The same for one source or a list of them; anything else, such as an array, stays as it is.

    A list of files of one tag each is one record.

    Examples
    --------
    >>> as_records([1.0, 2.0])
    [1.0, 2.0]
    """
    if (
        isinstance(source, list | tuple)
        and source
        and all(is_source(one) or isinstance(one, LoopRecord) for one in source)
    ):
        if len(source) > 1 and all(is_path(one) and holds_one_tag(Path(one)) for one in source):
            return read_loop(source, **settings)
        return [as_record(one, **settings) for one in source]
    return as_record(source, **settings) if is_source(source) else source
