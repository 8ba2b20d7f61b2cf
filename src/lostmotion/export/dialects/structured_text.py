"""IEC 61131-3 Structured Text: the subset that CODESYS, TwinCAT and OpenPLC share."""

from __future__ import annotations

from collections.abc import Mapping

from lostmotion.export import outside
from lostmotion.export.dialects.assemble import only_file
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import Declared, declare, render
from lostmotion.export.printer import Printer, Syntax
from lostmotion.export.source import Source

VERIFIED = (
    "this dialect is compiled and executed in the tests of lostmotion and compared with the simulated block; "
    "not verified in the vendor's tool."
)


def types(real: str) -> dict[str, str]:
    """Types of the kinds."""
    return {"real": real.upper(), "bool": "BOOL", "int": "DINT"}


def syntax(real: str) -> Syntax:
    """How ST is written."""
    name = real.upper()
    return Syntax(
        calls={
            "min": "MIN({0}, {1})",
            "max": "MAX({0}, {1})",
            "abs": "ABS({0})",
            "to real": f"DINT_TO_{name}({{0}})",
            "to int": f"{name}_TO_DINT({{0}})",
        },
        numbers="REAL#{}" if real == "real" else "{}",
    )


def parts(source: Source) -> tuple[Declared, list[str]]:
    """Declarations and lines of the body."""
    declared = declare(source, source.tree, types(source.real))
    return declared, Printer(syntax(source.real), declared.names).lines(source.tree.body)


def files(source: Source) -> dict[str, str]:
    """The block as one file of ST."""
    declared, body = parts(source)
    header = source.header(VERIFIED, outside.structured_text)
    text = render("structured_text.st.j2", name=source.name, header=header, rows=declared.rows, body=body)
    return {f"{source.name}.st": text}


def restore(files: Mapping[str, str]) -> str:
    """The file itself."""
    return only_file(files)[1]


DIALECT = Dialect(
    name="st",
    title="IEC 61131-3: CODESYS, TwinCAT, OpenPLC",
    endings=("st",),
    files=files,
    restore=restore,
    how_to_import=(
        "Paste the file into a new function block (CODESYS, TwinCAT, OpenPLC: declaration and body where the tool "
        "keeps them apart)."
    ),
    proven="compiled and executed by the ST machine of pyplcopen; parsed by blark and tree-sitter",
    unproven="import into a vendor's tool",
)
