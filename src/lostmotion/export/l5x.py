"""Rockwell add-on instruction as L5X.

Logix ST has neither MIN nor MAX nor TRUE and FALSE, so the tree is lowered first; with LREAL every statement has at
most two operands. Conversions between DINT and REAL are implicit in assignments and arithmetic.
"""

from __future__ import annotations

import datetime as dt

from lostmotion.export.frame import declare, render
from lostmotion.export.lower import without_bool_values, without_min_max
from lostmotion.export.printer import Dialect, Printer
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
    dialect = Dialect(calls={"abs": "ABS({0})", "to real": "{0}", "to int": "{0}"}, true="1", false="0")
    printer = Printer(dialect, declared.names)
    reset = [f"{row.name} := {row.default};" for row in declared.rows["state"]]
    day = dt.date.fromisoformat(source.date)
    text = render(
        "l5x.xml.j2",
        name=source.name,
        header=source.header(VERIFIED),
        rows=declared.rows,
        body=printer.lines(block.body),
        reset=["(* No retained data: the first scan starts anew. *)", *reset],
        export_date=f"{DAYS[day.weekday()]} {MONTHS[day.month - 1]} {day.day:02d} 00:00:00 {day.year:04d}",
        date=f"{source.date}T00:00:00.000Z",
    )
    return {f"{source.name}.L5X": text}
