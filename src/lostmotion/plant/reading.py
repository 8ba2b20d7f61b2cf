"""Settings of a source and of a loop -> the record of it, as read_loop makes it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

from lostmotion.errors import DataError, LostMotionError, ParameterError
from lostmotion.files.columns import usual
from lostmotion.files.opened import Opened
from lostmotion.files.quality import Trust
from lostmotion.files.read import read_loop, trust_of
from lostmotion.files.tags import one_loop, tag_and_role
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.parquet import Kind, schema_of
from lostmotion.records.record import LoopRecord
from lostmotion.records.span import about_unit

OF_ALL = ("op", "pv", "sp", "position", "time", "dt", "missing", "mode", "op_span", "pv_span")
OF_PLANT = ("uncertain", "quality", "automatic", "manual")
UNUSED = "none"  # column of times of a loop list
Reading = tuple[tuple[str, Any], ...]


def checked_reading(settings: Mapping[str, Any]) -> Reading:
    """Settings for all loops alike.

    Raises
    ------
    ParameterError
        One that is of a single loop, or none at all.
    """
    known = (*OF_ALL, *OF_PLANT)
    odd = [name for name in settings if name not in known]
    if odd:
        remedy = "give it in a loop list" if odd[0] in ("loop", "tag") else "leave it out"
        raise ParameterError.expected(f"settings for all loops alike ({', '.join(known)})", f"{odd[0]}=..", remedy)
    trust_of(settings)
    return tuple(sorted(settings.items()))


def trust(reading: Reading) -> Trust:
    """What is believed of qualities."""
    return trust_of(dict(reading))


def record_of(content: Opened, loop: PlantLoop, name: str, reading: Reading) -> LoopRecord:
    """Record of a loop from what was opened; what the loop says of itself goes before the settings of all.

    Parameters
    ----------
    content : Opened
    loop : PlantLoop
    name : str
        By which `content` knows it; empty: it is alone there.

    Raises
    ------
    LostMotionError
        As in read_loop.
    """
    settings: dict[str, Any] = dict(reading)
    own = {"op": loop.op, "pv": loop.pv, "sp": loop.sp, "mode": loop.mode, "dt": loop.dt}
    settings |= {role: value for role, value in own.items() if value}
    settings |= {"time": False if loop.time.lower() == UNUSED else loop.time} if loop.time else {}
    settings |= {"op_span": loop.op_span} if loop.op_span else {}
    settings |= {"pv_span": loop.pv_span} if loop.pv_span else {}
    if loop.op and loop.pv and not name:
        settings |= {role: False for role in ("sp", "mode") if role not in settings and _of_others(role, loop, content)}
    record = read_loop(content, tag=loop.tag, loop=name or None, **settings)
    return told(record, loop)


def _of_others(role: str, loop: PlantLoop, content: Opened) -> bool:
    """Whether the columns that look like a role are of other loops: OP and PV were named, this one was not."""
    names = content.table()[0].names
    if schema_of(names).kind is Kind.LONG:
        return True
    fits = usual(role, names)
    tags = [parsed[0] for parsed in map(tag_and_role, fits) if parsed is not None]
    own = [parsed[0] for parsed in map(tag_and_role, (loop.op, loop.pv)) if parsed is not None]
    return len(fits) > 1 or any(not one_loop(tag, mine) for tag in tags for mine in own)


def told(record: LoopRecord, loop: PlantLoop) -> LoopRecord:
    """Record with what the loop list knows of it."""
    known: dict[str, Any] = {
        "tag": loop.tag,
        "loop_type": loop.loop_type or record.loop_type,
        "op_unit": loop.op_unit or record.op_unit,
        "pv_unit": loop.pv_unit or record.pv_unit,
        "op_span": loop.op_span or _span_beside(loop.op_unit, record),
        "pv_span": loop.pv_span or record.pv_span,
    }
    same = all(getattr(record, name) == value for name, value in known.items())
    return record if same else replace(record, **known)


def _span_beside(unit: str, record: LoopRecord) -> tuple[float, float] | None:
    """Span of OP that a record has, unless it is that of a unit in which the loop list says that OP is not."""
    other = unit not in ("", record.op_unit) and about_unit(record.op_unit, record.op)[0] == record.op_span
    return None if other else record.op_span


def between(record: LoopRecord, since: datetime | None, until: datetime | None) -> LoopRecord:
    """What was recorded from `since` on and before `until`; a record without dates as it is, with a note.

    Raises
    ------
    DataError
        Nothing was.
    """
    if since is None and until is None:
        return record
    checked_range(since, until)
    if record.start is None:
        return _noted(record, "The record is not dated: all of it was taken, whatever was asked for.")
    local = record.start.tzinfo is None
    bounds: list[Any] = [_as_local(one) if local else one for one in (since, until)]
    try:
        part = record[bounds[0] : bounds[1]]
    except ParameterError:
        return _noted(record, "How much is missing at its gaps is not known: all of it was taken, whatever the dates.")
    except DataError as error:
        ends = f"{record.start} .. {record.moment(len(record) - 1) or 'unknown'}"
        asked = f"{since or ''} .. {until or ''}"
        raise DataError.expected(f"rows of {asked}", f"a record of {ends}", "ask for another time") from error
    return _noted(part, "Its times have no zone and were compared as UTC.") if local else part


def _as_local(moment: datetime | None) -> datetime | None:
    return None if moment is None else moment.astimezone(UTC).replace(tzinfo=None)


def _noted(record: LoopRecord, note: str) -> LoopRecord:
    return replace(record, notes=(*record.notes, note))


def checked_range(since: datetime | None, until: datetime | None) -> None:
    """Refuse moments without a time zone, and an end before the start.

    Raises
    ------
    ParameterError
        Of either kind.
    """
    for name, moment in (("since", since), ("until", until)):
        if moment is not None and moment.tzinfo is None:
            raise ParameterError.expected(f"{name} with a time zone", moment, "datetime.now(UTC) has one")
    if since is not None and until is not None and not since < until:
        raise ParameterError.expected("since before until", f"{since} and {until}", "swap them")


def tried(error: BaseException, loop: PlantLoop) -> LostMotionError:
    """Error of one loop as a value; one of the system or of a reader in our words."""
    if isinstance(error, LostMotionError):
        return error
    said = " ".join(str(error).split()) or type(error).__name__
    return DataError.expected(f"data of {loop.tag!r} that can be read", said, "check the file, or export it again")
