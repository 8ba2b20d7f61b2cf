"""Loop list: ``loops.csv`` with a line for each loop of a plant, read line by line and written."""

from __future__ import annotations

import csv
import difflib
import io
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError
from lostmotion.files.frames import read_bytes
from lostmotion.files.text import decode
from lostmotion.plant.loop import PlantLoop
from lostmotion.printable import cell_of, text_of

COLUMNS = (
    "tag", "op", "pv", "sp", "mode", "type", "op_low", "op_high", "pv_low", "pv_high", "op_unit", "pv_unit", "area",
    "weight", "file", "dt", "time", "slave", "remarks",
)  # fmt: skip
TYPES = ("flow", "pressure", "temperature", "level", "analyser", "concentration", "other")
_OWN = {"type", "op_low", "op_high", "pv_low", "pv_high", "area", "weight"}  # what no record has
SHOWN = 10  # errors of one list
LONGEST_SHOWN = 60  # characters of a name in a message
MOST_COLUMNS = 1000
_SETTING = re.compile(r"(?<!\w)(dt|time|op|pv|sp|mode)=(?=[\w'<])")
_TEXTS = ("op", "pv", "sp", "mode", "op_unit", "pv_unit", "area", "time", "slave")


@dataclass(frozen=True)
class LoopList:
    """Loops of a list, and what was passed over in it, one sentence each."""

    loops: tuple[PlantLoop, ...]
    notes: tuple[str, ...] = ()


def is_loop_list(names: Sequence[str]) -> bool:
    """Whether columns are those of a loop list: a tag, and most of the others too.

    Examples
    --------
    >>> is_loop_list(COLUMNS[:14]), is_loop_list(["tag", "op", "pv", "sp", "mode", "time"])
    (True, False)
    """
    known = {name.strip().lower() for name in names} & set(COLUMNS)
    return "tag" in known and len(known & _OWN) >= len(_OWN) // 2


def in_loop_list(text: str) -> str:
    """Words of the library about settings of a reader, in those of a loop list.

    Examples
    --------
    >>> in_loop_list("give dt=60, or dt=1 and time=False to ignore the times")
    'give dt=60, or dt=1 and time=none to ignore the times (columns of the loop list)'
    >>> in_loop_list("expected numbers in column 'PV', got 'abc'")
    "expected numbers in column 'PV', got 'abc'"
    """
    if not _SETTING.search(text) or "loop list" in text:
        return text
    return f"{text.replace('time=False', 'time=none')} (columns of the loop list)"


def read_loop_list(path: Path | str) -> LoopList:
    """Read a loop list.

    Parameters
    ----------
    path : path
        Of text separated by ``,`` ``;`` or tabs, with a header. Only `tag` is needed; lines that begin with # are
        passed over. `file` counts from the folder of the plant; without one the data are found by the tag or by the
        names in `op` and `pv`.

    Raises
    ------
    FileAccessError
        No such file.
    DataError
        A column or a line that is wrong: each is named, with its line.
    """
    name = Path(path).name
    return parse_loop_list(decode(read_bytes(Path(path)), name), name)


def parse_loop_list(text: str, name: str = "the loop list") -> LoopList:
    r"""Loop list of a text; see :func:`read_loop_list`.

    Examples
    --------
    >>> parse_loop_list("tag,op,pv,weight\nFIC101,FV101,FT101,2").loops[0].weight
    2.0
    >>> parse_loop_list("tag,weight\nFIC101,heavy")
    Traceback (most recent call last):
    ...
    lostmotion.errors.DataError: expected weight as a number, got 'heavy' in line 2 of the loop list; correct it
    """
    lines = [(number, line) for number, line in _rows(text, name) if any(cell.strip() for cell in line)]
    if not lines:
        raise DataError.expected(
            f"a header with the columns {', '.join(COLUMNS)} in {name}", "nothing", "let one be proposed, or write one"
        )
    header, notes = _header(lines[0][1], name)
    if len(lines) == 1:
        raise DataError.expected(
            f"a line for each loop in {name}", "a header only", "let one be proposed, or write one"
        )
    found: list[PlantLoop] = []
    wrong: list[str] = []
    first: dict[str, int] = {}
    for number, cells in lines[1:]:
        try:
            loop = _loop(header, cells, f"line {number} of {name}")
        except DataError as error:
            wrong.append(str(error))
            continue
        if loop.tag in first:
            where = f"{loop.tag!r} in line {first[loop.tag]} and line {number} of {name}"
            wrong.append(f"expected loops of different tags, got {where}; rename one or leave it out")
        first.setdefault(loop.tag, number)
        found.append(loop)
    if wrong:
        more = [f"and {len(wrong) - SHOWN} more lines"] if len(wrong) > SHOWN else []
        raise DataError("\n".join([*wrong[:SHOWN], *more]))
    return LoopList(tuple(found), notes)


def _rows(text: str, name: str) -> list[tuple[int, list[str]]]:
    """Lines that are no comments, cut into cells, with their numbers from 1."""
    top = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    delimiter = max(",;\t", key=top.count)
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter)
    rows: list[tuple[int, list[str]]] = []
    begin = 1
    try:
        for cells in reader:
            if not (cells and cells[0].lstrip().startswith("#")):
                rows.append((begin, cells))
            begin = reader.line_num + 1
    except csv.Error as error:
        raise DataError.expected(f"cells of text in {name}", f"{error} behind line {begin}", "correct it") from error
    return rows


def _header(cells: Sequence[str], name: str) -> tuple[list[str], tuple[str, ...]]:
    """Columns, "" for those that are passed over, and what to say of these."""
    named = [cell.strip().lower() for cell in cells]
    if len(named) > MOST_COLUMNS:
        raise DataError.expected(f"at most {MOST_COLUMNS} columns in {name}", len(named), "leave out what is not known")
    twice = next((cell for cell in named if cell and named.count(cell) > 1), None)
    if twice is not None:
        raise DataError.expected(f"each column once in {name}", f"{twice!r} twice", "leave one out")
    for cell in named:
        near = difflib.get_close_matches(cell, COLUMNS, n=1, cutoff=0.8) if cell not in COLUMNS else []
        if near and near[0] not in named:
            raise DataError.expected(f"a column {near[0]!r} in {name}", repr(cell), "correct its name")
    if "tag" not in named:
        said = f"{[cell[:LONGEST_SHOWN] for cell in named if cell][:SHOWN]}"
        raise DataError.expected(f"a column 'tag' in {name}", said, f"name the columns {', '.join(COLUMNS)}")
    odd = [cell for cell in named if cell and cell not in COLUMNS]
    shown = ", ".join(cell[:LONGEST_SHOWN] for cell in odd)
    notes = (f"Columns that are not known in {name} were passed over: {shown}.",) if odd else ()
    return [cell if cell in COLUMNS else "" for cell in named], notes


def _loop(header: Sequence[str], cells: Sequence[str], where: str) -> PlantLoop:
    """Loop of a line.

    Raises
    ------
    DataError
        A cell is outside its domain, or one too many.
    """
    if len(cells) > len(header) and any(cell.strip() for cell in cells[len(header) :]):
        raise DataError.expected(f"{len(header)} cells", f"{len(cells)} in {where}", "quote cells that hold a comma")
    row = {name: text_of(cell.strip()) for name, cell in zip(header, cells, strict=False) if name}
    if not row.get("tag"):
        raise DataError.expected("a tag", f"none in {where}", "name the loop")
    kind = row.get("type", "").lower()
    if kind and kind not in TYPES:
        raise DataError.expected(f"type as one of {', '.join(TYPES)}", f"{kind!r} in {where}", "choose one, or none")
    if bool(row.get("op")) != bool(row.get("pv")):
        given, other = ("op", "pv") if row.get("op") else ("pv", "op")
        raise DataError.expected("op and pv, or neither", f"{given} without {other} in {where}", "name both columns")
    if row.get("slave") == row["tag"]:
        raise DataError.expected("another loop as slave", f"{row['tag']!r} itself in {where}", "leave it out")
    texts: dict[str, Any] = {name: row.get(name, "") for name in _TEXTS}
    weight, dt = _number(row, "weight", where), _number(row, "dt", where)
    if weight is not None and weight < 0:
        raise DataError.expected("weight >= 0", f"{weight:g} in {where}", "1 is usual")
    if dt is not None and dt <= 0:
        raise DataError.expected("dt > 0", f"{dt:g} in {where}", "give the sampling time in seconds")
    return PlantLoop(
        row["tag"],
        **texts,
        loop_type=kind,
        op_span=_span(row, "op", where),
        pv_span=_span(row, "pv", where),
        weight=1.0 if weight is None else weight,
        where=row.get("file", ""),
        notes=tuple(filter(None, [row.get("remarks", "")])),
        dt=dt,
    )


def _number(row: Mapping[str, str], name: str, where: str) -> float | None:
    cell = row.get(name, "")
    if not cell:
        return None
    try:
        value = float(cell.replace(",", "."))
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise DataError.expected(f"{name} as a number", f"{cell!r} in {where}", "correct it")
    return value


def _span(row: Mapping[str, str], role: str, where: str) -> tuple[float, float] | None:
    low, high = _number(row, f"{role}_low", where), _number(row, f"{role}_high", where)
    if low is None and high is None:
        return None
    if low is None or high is None or not low < high:
        got = f"{row.get(f'{role}_low') or 'none'} and {row.get(f'{role}_high') or 'none'} in {where}"
        raise DataError.expected(f"{role}_low below {role}_high", got, "give both, or neither")
    return low, high


def loop_list_text(loops: Iterable[PlantLoop]) -> str:
    """Loop list as text.

    Examples
    --------
    >>> print(loop_list_text([PlantLoop("FIC101", "FV101", "FT101", op_span=(0, 100))]).splitlines()[1])
    FIC101,FV101,FT101,,,,0,100,,,,,,1,,,,,
    """
    out = io.StringIO(newline="")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([cell_of(cell) for cell in _cells(loop)] for loop in loops)
    return out.getvalue()


def _cells(loop: PlantLoop) -> list[str]:
    ends = [*(loop.op_span or ("", "")), *(loop.pv_span or ("", ""))]
    return [
        loop.tag, loop.op, loop.pv, loop.sp, loop.mode, loop.loop_type, *(_shown(end) for end in ends), loop.op_unit,
        loop.pv_unit, loop.area, _shown(loop.weight), loop.where, _shown("" if loop.dt is None else loop.dt),
        loop.time, loop.slave, " ".join(loop.notes),
    ]  # fmt: skip


def _shown(value: float | str) -> str:
    """Shortest text that reads back as the same number."""
    if isinstance(value, str):
        return value
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e15 else repr(float(value))
