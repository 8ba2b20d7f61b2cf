"""Siemens SCL source (S7-1200 and S7-1500)."""

from __future__ import annotations

from lostmotion.export.frame import declare, render
from lostmotion.export.printer import Dialect, Printer
from lostmotion.export.source import Source

VERIFIED = (
    "structure and names are checked, and the body, turned back into IEC ST word by word, is compiled, executed and "
    "compared with the simulated block in the tests of lostmotion; not verified in the vendor's tool."
)


def files(source: Source) -> dict[str, str]:
    """The block as one external source file for TIA Portal."""
    real = source.real.upper()
    types = {"real": "LReal" if source.real == "lreal" else "Real", "bool": "Bool", "int": "DInt"}
    declared = declare(source, source.tree, types)
    dialect = Dialect(
        calls={
            "min": "MIN(IN1 := {0}, IN2 := {1})",
            "max": "MAX(IN1 := {0}, IN2 := {1})",
            "abs": "ABS({0})",
            "to real": f"DINT_TO_{real}({{0}})",
            "to int": f"{real}_TO_DINT({{0}})",
        },
        variable=dict.fromkeys(("input", "parameter", "output", "state", "local"), "#{}"),
        numbers="REAL#{}" if source.real == "real" else "{}",
    )
    body = Printer(dialect, declared.names).lines(source.tree.body, depth=1)
    header = source.header(VERIFIED)
    text = render("scl.scl.j2", name=source.name, header=header, rows=declared.rows, body=body)
    return {f"{source.name}.scl": text}
