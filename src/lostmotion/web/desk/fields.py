"""Fields of the page's small forms <-> settings of the library."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any
from urllib.parse import parse_qsl

from starlette.exceptions import HTTPException
from starlette.requests import Request

from lostmotion.errors import ParameterError
from lostmotion.web.worker.task import JUDGING, READING

MOST_FORM = 65_536  # bytes
NONE, COLUMN = "none", "="  # value of "do not read it"; sign before the name of a column
ROLES = ("op", "pv", "sp", "mode", "time", "position")
TITLE = {
    "op": "OP, output of the controller", "pv": "PV, measurement", "sp": "SP, set point", "mode": "Mode of the loop",
    "time": "Time", "position": "Position of the valve", "dt": "Sampling time, s", "loop": "Loop",
    "op_span": "Span of OP", "pv_span": "Span of PV", "automatic": "Words for automatic in the mode",
    "manual": "Manual is",
    "quality": "Quality columns", "loop_type": "PV measures", "integrating": "The process integrates (a level)",
    "uncertain": "Uncertain values", "retune": "Retune", "span": "Span of OP", "gain": "Gain of the process",
    "method": "Method", "tolerance": "Tolerance",
}  # fmt: skip
VALUE = r"<[^>]*>|'[^']*'|\"[^\"]*\"|\([^)]*\)|[\w.+-]*\w"
SETTING = re.compile(rf"(?<![\w-])({'|'.join(TITLE)})=({VALUE})?(?!=)")
PLAIN = {"False": "do not read it", "True": "yes"}
BARE = re.compile(r"(?<= )op_span(?= )")
LOOP_TYPES = ("flow", "pressure", "temperature", "level", "analyser", "concentration", "other")
LONGEST = 300  # characters of a text


async def fields(request: Request) -> dict[str, str]:
    """Fields of a small form; of one that comes twice the last."""
    body = bytearray()
    async for piece in request.stream():
        body += piece
        if len(body) > MOST_FORM:
            raise HTTPException(413, "The form is too large.")
    pairs = parse_qsl(body.decode("utf-8", "replace"), keep_blank_values=True, max_num_fields=100)
    return dict(pairs)


def settings_of(form: Mapping[str, str], before: Mapping[str, Any]) -> dict[str, Any]:
    """Settings of a record from the form of its columns; what the form does not know stays.

    Examples
    --------
    >>> settings_of({"op": "=OUT 1", "sp": "none", "dt": "2.5", "op_low": "0", "op_high": "100"}, {"loop": "FIC1"})
    {'loop': 'FIC1', 'op': 'OUT 1', 'sp': False, 'dt': 2.5, 'op_span': [0.0, 100.0]}
    """
    known = ("loop", "quality", "uncertain", "manual", "pv_span")
    found: dict[str, Any] = {name: before[name] for name in known if name in before}
    for role in ROLES:
        value = form.get(role, "")
        if value == NONE and role not in ("op", "pv"):
            found[role] = False
        elif value.startswith(COLUMN):
            found[role] = value[1:]
    dt = number(form, "dt")
    if dt is not None:
        found["dt"] = dt
    span = [number(form, "op_low"), number(form, "op_high")]
    if span[0] is not None and span[1] is not None:
        found["op_span"] = span
    words = [word.strip() for word in form.get("automatic", "")[:LONGEST].split(",") if word.strip()]
    if words:
        found["automatic"] = words
    if form.get("loop_type") in LOOP_TYPES:
        found["loop_type"] = form["loop_type"]
    if form.get("integrating") in ("yes", "no"):
        found["integrating"] = form["integrating"] == "yes"
    return found


def number(form: Mapping[str, str], name: str) -> float | None:
    """Number of a field; None: it is empty.

    Raises
    ------
    ParameterError
        It is none.
    """
    text = form.get(name, "").strip().replace(",", ".")
    if not text:
        return None
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ParameterError.expected(f"a number as {TITLE.get(name, name)}", text[:40], "write it with digits")
    return value


def way_of(error: Mapping[str, Any], place: str) -> dict[str, Any]:
    """Settings of one way on that an error names, by its place in the list."""
    ways = error.get("ways", [])
    if place not in map(str, range(len(ways))):
        raise HTTPException(404)
    return {name: value for name, value in ways[int(place)].items() if name in (*READING, *JUDGING)}


def way_words(way: Mapping[str, Any]) -> str:
    """What a button for it says.

    Examples
    --------
    >>> way_words({"dt": 30.0, "time": False}), way_words({"op": "CO", "pv": "Y"})
    ('Sampling time, s: 30; Time: not read', 'OP: CO; PV: Y')
    """
    said = []
    for name, value in way.items():
        shown = "not read" if value is False else "yes" if value is True else value
        shown = f"{value:g}" if isinstance(value, float) else shown
        title = name.upper() if name in ("op", "pv", "sp") else TITLE.get(name, name)
        said.append(f"{title}: {shown}")
    return "; ".join(said)


def in_fields(text: str) -> str:
    """Words of the library about its settings, in those of the page's fields.

    Examples
    --------
    >>> in_fields("name it with op='<column>'"), in_fields("pass dt=<seconds>, or time=False")
    ('name it with “OP, output of the controller”', 'pass “Sampling time, s”, or “Time”: do not read it')
    >>> in_fields("The OP span was taken as 0 .. 100; give op_span where it is not.")
    'The OP span was taken as 0 .. 100; give “Span of OP” where it is not.'
    """
    return BARE.sub("“Span of OP”", SETTING.sub(_in_field, text))


def _in_field(found: re.Match[str]) -> str:
    name, value = found[1], (found[2] or "").strip("'\"")
    title = f"“{TITLE[name]}”"
    if not value or value[0] in "<(":
        return title
    return f"{title}: {PLAIN.get(value, value)}"


def study_given(form: Mapping[str, str], before: Mapping[str, Any]) -> dict[str, Any]:
    """What the study is given by its form: numbers that it has fields for, all else as before.

    A reason to go on counts for the gate that was read when it was typed: it is kept for "use" (settings that this very
    study asks for), never for another study.

    Examples
    --------
    >>> before = {"kp": 1.0, "ki": 0.5, "accept": "changed in May"}
    >>> study_given({"kp": "2", "ki": ""}, before), study_given({"accept": "now"}, before)
    ({'kp': 2.0}, {'kp': 1.0, 'ki': 0.5, 'accept': 'now'})
    """
    fresh = ("kp", "ki", "gain", "span") if "kp" in form else ()
    given = {name: value for name, value in before.items() if name not in fresh}
    if not form.get("use"):
        given.pop("accept", None)
    given |= {name: value for name in ("kp", "ki", "gain") if (value := number(form, name)) is not None}
    span = [number(form, "low"), number(form, "high")]
    if span[0] is not None and span[1] is not None:
        given["span"] = span
    reason = form.get("accept", "").strip()[:LONGEST]
    return given | ({"accept": reason} if reason else {})
