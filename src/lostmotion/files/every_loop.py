"""read_loops: a source with several loops -> the record of each, by its name."""

from __future__ import annotations

from typing import Any

from lostmotion.errors import DataError, ParameterError
from lostmotion.files.gathered import gathered, grouped
from lostmotion.files.opened import Opened, opened
from lostmotion.files.read import read_loop, trust_of
from lostmotion.records.record import LoopRecord


def read_loops(source: Any, **settings: Any) -> dict[str, LoopRecord]:
    """Read every loop of a source that holds several.

    Parameters
    ----------
    source : path, data frame or list of paths
        A wide file (FIC101.PV, FIC101.OUT, FIC102.PV ..), a table of tags and values, or a folder, a pattern or a list
        of files: each a whole record, or each of one tag.
    **settings
        Those of :func:`lostmotion.read_loop`, for all loops alike; but `loop`, `tag`, `op`, `pv` and `position`.

    Returns
    -------
    dict of str to LoopRecord
        By the name of the loop, in the order of the source; one entry where there is one loop.

    Raises
    ------
    LostMotionError
        As in read_loop, for the first loop that cannot be read.
    DataError
        Two files give loops of one name.

    Examples
    --------
    >>> import polars as pl
    >>> columns = {"t_s": [0, 1, 2]} | {f"FIC{n}.{role}": [n, 5, 7] for n in (1, 2) for role in ("PV", "OUT")}
    >>> read_loops(pl.DataFrame(columns))["FIC2"].op
    array([2., 5., 7.])
    """
    named = [name for name in ("loop", "tag", "op", "pv", "position") if name in settings]
    if named:
        raise ParameterError.expected("settings for all loops alike", f"{named[0]}=..", "read that loop with read_loop")
    paths, trust = gathered(source), trust_of(settings)
    if paths is None:
        return _loops(opened(source, query=settings.pop("query", None)), settings)
    found: dict[str, LoopRecord] = {}
    for group in grouped(paths):
        records = _loops(opened(list(group) if isinstance(group, tuple) else group, trust=trust), settings)
        again = sorted(set(found) & set(records))
        if again:
            raise DataError.expected("loops of different names", f"{again[0]!r} twice", "rename one of the files")
        found |= records
    return found


def _loops(content: Opened, settings: dict[str, Any]) -> dict[str, LoopRecord]:
    """Each loop of what was opened once."""
    names = content.loops()
    if not names:
        record = read_loop(content, **settings)
        return {record.tag: record}
    return {name: read_loop(content, loop=name, **settings) for name in names}
