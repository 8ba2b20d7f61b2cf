"""Rockwell add-on instruction as L5X.

Logix ST has neither MIN nor MAX nor TRUE and FALSE, so the tree is lowered first; with LREAL every statement has at
most two operands. Conversions between DINT and REAL are implicit in assignments and arithmetic.
"""

from __future__ import annotations

import datetime as dt
import re
from collections.abc import Mapping
from xml.etree import ElementTree as ET

from lostmotion.export import outside
from lostmotion.export.dialects.assemble import Declaration, assemble, only_file
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import declare, render
from lostmotion.export.lower import without_bool_values, without_min_max
from lostmotion.export.printer import Printer, Syntax
from lostmotion.export.source import Source

VERIFIED = (
    "structure and names are checked, and the body, turned back into IEC ST word by word, is compiled, executed and "
    "compared with the simulated block in the tests of lostmotion; not verified in the vendor's tool."
)
DAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")
MONTHS = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")


def files(source: Source) -> dict[str, str]:
    """The add-on instruction as one L5X file."""
    block = without_bool_values(without_min_max(source.tree, two_operands=source.real == "lreal"))
    types = {"real": source.real.upper(), "bool": "BOOL", "int": "DINT"}
    declared = declare(source, block, types, true="1", false="0")
    syntax = Syntax(calls={"abs": "ABS({0})", "to real": "{0}", "to int": "{0}"}, true="1", false="0")
    printer = Printer(syntax, declared.names)
    reset = [f"{row.name} := {row.default};" for row in declared.rows["state"]]
    day = dt.date.fromisoformat(source.date)
    text = render(
        "l5x.xml.j2",
        name=source.name,
        header=source.header(VERIFIED, outside.structured_text),
        rows=declared.rows,
        body=printer.lines(block.body),
        reset=["(* No retained data: the first scan starts anew. *)", *reset],
        export_date=f"{DAYS[day.weekday()]} {MONTHS[day.month - 1]} {day.day:02d} 00:00:00 {day.year:04d}",
        date=f"{source.date}T00:00:00.000Z",
    )
    return {f"{source.name}.L5X": text}


def restore(files: Mapping[str, str]) -> str:
    """Declarations from parameters and local tags; conversions that Logix does by itself written out."""
    name, text = only_file(files)
    root = ET.fromstring(text.encode())  # noqa: S314  our own file
    declarations: list[Declaration] = []
    for tag in [*root.iterfind(".//Parameter"), *root.iterfind(".//LocalTag")]:
        if tag.attrib["Name"] in ("EnableIn", "EnableOut"):
            continue
        word = {"Input": "VAR_INPUT", "Output": "VAR_OUTPUT"}.get(tag.attrib.get("Usage", ""), "VAR")
        kind, default = tag.attrib["DataType"], (tag.findtext("DefaultData") or "").strip()
        if kind == "BOOL":
            default = {"0": "FALSE", "1": "TRUE"}[default]
        declarations.append((word, tag.attrib["Name"], kind, default))
    lines = [line.text or "" for line in root.iterfind(".//Routine[@Name='Logic']//Line")]
    types = {variable: kind for _, variable, kind, _ in declarations}
    return assemble(name, declarations, "\n".join(_explicit(line, types) for line in lines))


def _explicit(line: str, types: dict[str, str]) -> str:
    """Logix assignment with the conversions that it does by itself written out."""
    found = re.fullmatch(r"(\s*)(\w+) := (.*);", line)
    if not found:
        return line
    pad, target, value = found.groups()
    kind = types[target]
    if kind == "BOOL" and value in ("0", "1"):
        value = "TRUE" if value == "1" else "FALSE"
    source = types.get(value, kind)
    if "DINT" in (kind, source) and kind != source:
        value = f"{source}_TO_{kind}({value})"
    return f"{pad}{target} := {value};"


DIALECT = Dialect(
    name="l5x",
    title="Rockwell add-on instruction",
    endings=("L5X",),
    files=files,
    restore=restore,
    how_to_import=(
        "Studio 5000: right-click Add-On Instructions, Import Add-On Instruction. LREAL needs a controller that has it."
    ),
    proven="XML, structure and names checked; the body turned back into ST by rules on the text, then executed",
    unproven="any Rockwell compiler",
)
