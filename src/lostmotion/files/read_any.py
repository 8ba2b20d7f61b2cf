"""Read one source or several: for :func:`lostmotion.records.as_record`, which lies below the readers."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lostmotion.files.gathered import holds_one_tag
from lostmotion.files.paths import is_path
from lostmotion.files.read import read_loop
from lostmotion.records.record import LoopRecord


def read_any(source: Any, **settings: Any) -> LoopRecord | list[LoopRecord]:
    """Read a source, or each of a list; a list of files of one tag each is one record.

    Parameters
    ----------
    source : path, data frame, mapping of columns, or a list of these
    **settings
        Those of :func:`lostmotion.read_loop`.

    Raises
    ------
    LostMotionError
        As in read_loop.

    Examples
    --------
    >>> read_any([{"t_s": [0, 1, 2], "OP": [1, 2, 3], "PV": [3, 2, 1]}])
    [LoopRecord('': 3 samples of OP, PV every 1 s, 3 s)]
    """
    if not isinstance(source, list | tuple):
        return read_loop(source, **settings)
    if len(source) > 1 and all(is_path(one) and holds_one_tag(Path(one)) for one in source):
        return read_loop(source, **settings)
    return [read_loop(one, **settings) for one in source]
