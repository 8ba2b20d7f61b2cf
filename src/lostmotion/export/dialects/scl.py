"""Siemens SCL source (S7-1200 and S7-1500)."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lostmotion.export import outside
from lostmotion.export.dialects.assemble import only_file
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import declare, render
from lostmotion.export.printer import Printer, Syntax
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
    syntax = Syntax(
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
    body = Printer(syntax, declared.names).lines(source.tree.body, depth=1)
    header = source.header(VERIFIED, outside.scl)
    text = render("scl.scl.j2", name=source.name, header=header, rows=declared.rows, body=body)
    return {f"{source.name}.scl": text}


def restore(files: Mapping[str, str]) -> str:
    """Without what SCL adds: # before names, names of arguments, attributes, quotes."""
    text = only_file(files)[1]
    text = re.sub(r"\bREAL#", "REAL@", text)
    text = re.sub(r"^\{ S7.*\}$|^VERSION.*$|^BEGIN$|\bIN[12] := |#", "", text, flags=re.MULTILINE)
    text = text.replace("REAL@", "REAL#").replace("VAR_TEMP", "VAR")
    text = re.sub(r'^FUNCTION_BLOCK "(\w+)"', r"FUNCTION_BLOCK \1", text, flags=re.MULTILINE)
    return re.sub(r": (LReal|Real|Bool|DInt)\b", lambda found: f": {found[1].upper()}", text)


DIALECT = Dialect(
    name="scl",
    title="Siemens S7-1200, S7-1500",
    endings=("scl",),
    files=files,
    restore=restore,
    how_to_import="TIA Portal: External source files, Add new external file, then Generate blocks from source.",
    proven="structure, names and words checked; the body turned back into ST by rules on the text, then executed",
    unproven="any Siemens compiler",
)
