"""LoopView <-> JSON: the rows of one loop as a store would have them, kept beside a dropped file."""

from __future__ import annotations

import math
from base64 import b64decode, b64encode
from collections.abc import Mapping
from datetime import datetime
from typing import Any, TypeVar

from lostmotion.audit.plant_view import LoopView
from lostmotion.errors import DataError
from lostmotion.plant import PlantLoop
from lostmotion.store.encoded import coded
from lostmotion.store.rows import AssessmentRow, TraceRow

Row = TypeVar("Row")
MARK = "not finite"  # key of the one-entry dictionary that stands for a number that JSON has no word for


def view_to_json(view: LoopView) -> dict[str, Any]:
    """Rows of a view without history, JSON-ready.

    Examples
    --------
    >>> from lostmotion.store.rows import UNDATED
    >>> row = AssessmentRow("FIC-1", UNDATED, UNDATED, evidence=(("a", float("nan"), 1.0),))
    >>> again = view_of_json(view_to_json(LoopView(PlantLoop("FIC-1"), row, None)))
    >>> again.row.tag, again.row.window_start == UNDATED, again.row.evidence
    ('FIC-1', True, (('a', nan, 1.0),))
    """
    trace = None if view.trace is None else _row_to_json(view.trace)
    return {"loop": _row_to_json(view.loop), "row": _row_to_json(view.row), "trace": trace, "notes": list(view.notes)}


def view_of_json(data: Mapping[str, Any]) -> LoopView:
    """View of what :func:`view_to_json` made.

    Raises
    ------
    DataError
        It is something else.
    """
    try:
        row = _row_of_json(AssessmentRow, data["row"])
        trace = None if data["trace"] is None else _row_of_json(TraceRow, data["trace"])
        loop, notes = _row_of_json(PlantLoop, data["loop"]), tuple(str(one) for one in data["notes"])
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise DataError.expected("the rows of a loop", type(error).__name__, "diagnose the record again") from error
    return LoopView(loop, row, trace, (row,), notes=notes)


def _row_to_json(row: Any) -> dict[str, Any]:
    return {one.name: plain(getattr(row, one.name)) for one in coded(type(row))}


def _row_of_json(kind: type[Row], data: Mapping[str, Any]) -> Row:
    read: dict[str, Any] = {}
    for one in coded(kind):
        value = _back(data[one.name])
        if value is not None and one.kind == "moment":
            value = datetime.fromisoformat(value)
        elif value is not None and one.kind == "bytes":
            value = b64decode(value, validate=True)
        read[one.name] = one.of(value) if one.of is not None else value
    return kind(**read)


def plain(value: Any) -> Any:
    """JSON-ready: moments as ISO texts, bytes in base 64, numbers that are none marked."""
    if isinstance(value, float) and not math.isfinite(value):
        return {MARK: str(value)}
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, bytes):
        return b64encode(value).decode("ascii")
    if isinstance(value, Mapping):
        return {str(key): plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return value


def _back(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(_back(one) for one in value)
    if isinstance(value, dict):
        if set(value) == {MARK}:
            return float(value[MARK])
        return {key: _back(one) for key, one in value.items()}
    return value
