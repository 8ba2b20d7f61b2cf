"""Files of one tag each -> one table, each tag at times of its own."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import narwhals.stable.v2 as nw
import polars as pl

from lostmotion.arrays import FloatArray
from lostmotion.errors import ColumnError, TimeError
from lostmotion.files.began import open_date
from lostmotion.files.columns import time_unit
from lostmotion.files.dates import zone_of
from lostmotion.files.long import good_cells, wide
from lostmotion.files.names import ENDS
from lostmotion.files.number_cells import decimal_mark, is_text, text_cells, to_numbers
from lostmotion.files.one_tag import OneTag, has_tag, role_of
from lostmotion.files.order import HOUR, arranged
from lostmotion.files.quality import ALL, Trust
from lostmotion.files.table import Table
from lostmotion.files.tags import BRACKETS, isa
from lostmotion.files.times import DAY, Stamps, read_times

SHOWN = 6  # files in a note
Files = Sequence[tuple[Path, OneTag]]


def joined(files: Files, source: str, asked: Collection[str] = (), trust: Trust = ALL) -> Table:
    """Table with a column of times and one for each tag; a cell is empty where a tag has no value of that time.

    Parameters
    ----------
    files : sequence of (Path, OneTag)
        Several files of one tag are taken as its values, one behind the other.
    source : str
        What the user called them together, for messages.
    asked : collection of str
        Columns that the user named: a file of that name, without its ending, is meant.
    trust : Trust
        What is believed of the qualities in the files.

    Raises
    ------
    ColumnError
        A file says one role inside and another in its name; two files of one role that name no tag; two values of one
        tag at one time.
    TimeError
        Some files have times and others none, or the times are of different kinds.
    """
    names = _names(files, asked)
    twice = [name for name, count in Counter(names).items() if count > 1]
    if unnamed := [name for name in twice if not has_tag(name)]:
        where = [path.name for (path, _), name in zip(files, names, strict=True) if name == unnamed[0]]
        raise ColumnError.expected(
            "files of different tags",
            f"{unnamed[0]!r} in {' and '.join(where)}",
            "leave one out",
        )
    note = _note(files, names)
    ones = [one for _, one in files]
    together = _side_by_side if not twice and _one_clock(ones) else _by_times
    table = together(ones, names, source, trust)
    above = tuple(line for one in ones for line in one.table.notes)
    delimiters = {one.table.delimiter for one in ones}
    delimiter = delimiters.pop() if len(delimiters) == 1 else ""
    return Table(table.frame, source, None, delimiter, (note, *dict.fromkeys(above), *table.notes), table.own_times)


def _names(files: Files, asked: Collection[str]) -> list[str]:
    """What each tag is called: as the user named its file, as the file says inside, or as it is called."""
    lower = {name.strip().lower() for name in asked}
    told = [[] if path_stem(path).lower() in lower else one.told(path_stem(path)) for path, one in files]
    odd = next((place for place, names in enumerate(told) if len({role_of(name) for name in names}) > 1), None)
    if odd is not None:
        said = " and ".join(f"{role_of(name).upper()} in {name!r}" for name in told[odd])
        error = ColumnError.expected(
            f"one role of {files[odd][0].name!r}", said, "name the files: op='<name>' and pv='<name>'"
        )
        raise error.leads_on(*_ways([path_stem(path) for path, _ in files], told))
    return [_name(path_stem(path), names) for (path, _), names in zip(files, told, strict=True)]


def name_of(path: Path, one: OneTag) -> str:
    """What the tag of a file is called, by what it says inside and by its own name.

    Examples
    --------
    >>> frame = nw.from_native(pl.DataFrame({"Time": ["1", "2"], "Value": ["5", "6"]}), eager_only=True)
    >>> name_of(Path("FIC101_OP.csv"), OneTag(Table(frame, "FIC101_OP.csv"), "Value", "Time", None))
    'FIC101_OP'
    """
    stem = path_stem(path)
    return _name(stem, one.told(stem))


def _name(stem: str, told: Sequence[str]) -> str:
    """The first name that tells tag and role; of a role alone, with the tag that the file is called by."""
    named = next((name for name in told if has_tag(name)), told[0] if told else stem)
    whose = BRACKETS.sub("", stem)
    if told and not has_tag(named) and isa(whose) is not None and role_of(named) in ENDS:
        return f"{whose}.{role_of(named).upper()}"
    return named


def _ways(stems: Sequence[str], told: Sequence[Sequence[str]]) -> list[Mapping[str, object]]:
    """Settings by what the files are called, and by what they say inside."""
    ways: list[Mapping[str, object]] = []
    for place in (-1, 0):
        roles: dict[str, object] = {
            role_of(names[place]): stem for stem, names in zip(stems, told, strict=True) if names
        }
        if {"op", "pv"} <= set(roles):
            ways.append({role: roles[role] for role in ("op", "pv", "sp") if role in roles})
    return ways


def path_stem(path: Path) -> str:
    """Name of a file without its endings.

    Examples
    --------
    >>> path_stem(Path("data/FIC101_OP.csv.gz")), path_stem(Path("FIC101.OP.csv"))
    ('FIC101_OP', 'FIC101.OP')
    """
    return Path(path.stem).stem if path.suffix.lower() in (".gz", ".zip") else path.stem


def _note(files: Files, names: Sequence[str]) -> str:
    shown = [f"{name} from {path.name}" for (path, _), name in zip(files, names, strict=True)]
    more = f" and {len(shown) - SHOWN} more" if len(shown) > SHOWN else ""
    return f"Joined from {len(files)} files of one tag each: {', '.join(shown[:SHOWN])}{more}."


def _one_clock(ones: Sequence[OneTag]) -> bool:
    """Whether all files have the same times, row by row, or none at all."""
    clocks = [None if one.time is None else one.table.column(one.time).to_list() for one in ones]
    if all(clock is None for clock in clocks):
        lengths = {len(one.table.frame) for one in ones}
        if len(lengths) > 1:
            raise TimeError.expected("files with times", f"none, and {sorted(lengths)} rows", "export the times too")
        return True
    if any(clock is None for clock in clocks):
        without = [one.table.source for one in ones if one.time is None]
        raise TimeError.expected("times in every file", f"none in {', '.join(without)}", "export the times too")
    return all(clock == clocks[0] for clock in clocks) and len({time_unit(str(one.time)) for one in ones}) == 1


def _side_by_side(ones: Sequence[OneTag], names: Sequence[str], source: str, trust: Trust) -> Table:
    first = ones[0]
    columns: dict[str, pl.Series] = {}
    if first.time is not None:
        columns[first.time] = _native(first.table, first.time)
    notes: list[str] = []
    for one, name in zip(ones, names, strict=True):
        columns[name], said = good_cells(one.table, one.value, one.quality, trust, name)
        notes += said
    return Table(nw.from_native(pl.DataFrame(columns), eager_only=True), source, notes=tuple(notes))


def _by_times(ones: Sequence[OneTag], names: Sequence[str], source: str, trust: Trust) -> Table:
    """A row for every time of any tag."""
    whole = _concatenated(ones)
    decimal = decimal_mark(whole, list(whole.names))
    stamps = read_times(whole, whole.names[0], decimal)
    parts, notes, end, set_back = [], list(stamps.notes), 0, False
    for one, name in zip(ones, names, strict=True):
        begin, end = end, end + len(one.table.frame)
        cells, said = good_cells(one.table, one.value, one.quality, trust, name)
        values, codes, words = _values(cells, name, decimal, one.table)
        dates = None if stamps.dates is None else stamps.dates[begin:end]
        own = replace(stamps, seconds=stamps.seconds[begin:end], dates=dates, name=str(one.time), table=one.table)
        found = arranged(own, [codes])
        set_back = set_back or found.set_back
        notes += [*said, *words, *(f"{one.table.source}: {note}" for note in found.notes)]
        parts.append(pl.DataFrame({"time": found.seconds, "tag": name, "value": values[found.rows.tolist()]}))
    notes += open_date(stamps)
    time = str(ones[0].time)
    frame = wide(pl.concat(parts, how="vertical_relaxed").filter(pl.col("time").is_not_nan()), time)
    frame = frame.with_columns(_clock(frame[time], stamps, dated=not set_back and stamps.certain).alias(time))
    return Table(nw.from_native(frame, eager_only=True), source, notes=tuple(notes), own_times=True)


def _concatenated(ones: Sequence[OneTag]) -> Table:
    """Times and values of all files: a day above 12 in one of them tells the order of day and month in all."""
    if len({time_unit(str(one.time)) for one in ones}) > 1:
        raise _unlike(ones)
    times = [_native(one.table, str(one.time)) for one in ones]
    values = [_native(one.table, one.value).cast(pl.String) for one in ones]
    if len({times_of.dtype for times_of in times}) > 1:
        raise _unlike(ones)
    columns = {str(ones[0].time): pl.concat([one.alias("") for one in times])}
    frame = pl.DataFrame({**columns, " values": pl.concat([one.alias("") for one in values])})
    delimiters = {one.table.delimiter for one in ones}
    return Table(nw.from_native(frame, eager_only=True), "the files together", None, min(delimiters))


def _values(cells: pl.Series, name: str, decimal: str, table: Table) -> tuple[pl.Series, FloatArray, tuple[str, ...]]:
    """Values of a tag, numbers that tell whether two are the same, and which words were passed over."""
    if role_of(name) == "mode":
        return cells.cast(pl.String), cells.cast(pl.String).rank("dense").cast(pl.Float64).to_numpy(), ()
    column = Table(nw.from_native(pl.DataFrame({name: cells}), eager_only=True), table.source, table.lines)
    values, words = to_numbers(column, name, decimal)
    return pl.Series(values), values, words


def _clock(seconds: pl.Series, stamps: Stamps, dated: bool) -> pl.Series:
    """Times as dates where they are and can be told, else as they were read."""
    zone = _zone(stamps)
    if stamps.dates is None and not (stamps.epoch or stamps.local or zone):
        return (seconds / stamps.scale).alias("time")
    if stamps.origin < DAY or not dated:  # times of day, or since an unknown day
        whole = ((seconds + stamps.origin % DAY) * 1e6).round().cast(pl.Int64)
        return whole.cast(pl.Duration("us")).alias("time")
    whole = ((seconds + stamps.origin) * 1e6).round().cast(pl.Int64)
    moments = whole.cast(pl.Datetime("us"))
    if not stamps.local:
        moments = moments.dt.replace_time_zone("UTC").dt.convert_time_zone(zone or "UTC")
    return moments.alias("time")


def _zone(stamps: Stamps) -> str:
    """Name of the zone of the dates of a frame, or of the whole hours by which those of a text are ahead of UTC."""
    if stamps.dates is None:
        return str(getattr(stamps.table.column(stamps.name).dtype, "time_zone", None) or "")
    hours = zone_of(stamps.dates) / HOUR
    return f"Etc/GMT{-hours:+.0f}" if hours and hours == round(hours) else ""


def _native(table: Table, name: str) -> pl.Series:
    series = table.column(name)
    return text_cells(series) if is_text(series) else pl.Series(name, series.to_list())


def _unlike(ones: Sequence[OneTag]) -> TimeError:
    shown = " and ".join(f"{one.time!r} in {one.table.source!r}" for one in ones[:2])
    return TimeError.expected("times of one kind in all files", shown, "export all tags in one way")
