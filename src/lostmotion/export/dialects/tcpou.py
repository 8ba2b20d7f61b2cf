"""TwinCAT .TcPOU: the ST of :mod:`structured_text` in TwinCAT's XML."""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from xml.etree import ElementTree as ET

from lostmotion.export import outside
from lostmotion.export.dialects import structured_text
from lostmotion.export.dialects.assemble import only_file
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import render
from lostmotion.export.source import Source

VERIFIED = (
    "the ST inside is compiled and executed in the tests of lostmotion and compared with the simulated block, "
    "the file is parsed; not verified in the vendor's tool."
)


def files(source: Source) -> dict[str, str]:
    """The block as one .TcPOU; its Id follows from the text, so the same input gives the same file."""
    declared, body = structured_text.parts(source)
    header = source.header(VERIFIED, outside.structured_text)
    identity = uuid.uuid5(uuid.NAMESPACE_URL, "\n".join([source.name, *header, *body]))
    text = render("tcpou.xml.j2", name=source.name, id=identity, header=header, rows=declared.rows, body=body)
    return {f"{source.name}.TcPOU": text}


def restore(files: Mapping[str, str]) -> str:
    """Declaration and body one after the other."""
    text = only_file(files)[1]
    pou = ET.fromstring(text.encode()).find("POU")  # noqa: S314  our own file
    assert pou is not None  # noqa: S101
    return f"{pou.findtext('Declaration')}\n{pou.findtext('Implementation/ST')}\nEND_FUNCTION_BLOCK\n"


DIALECT = Dialect(
    name="tcpou",
    title="TwinCAT `.TcPOU`",
    endings=("TcPOU",),
    files=files,
    restore=restore,
    how_to_import=(
        "TwinCAT: right-click POUs, Add, Existing Item. If floating point exceptions are on for the task, a NaN at"
        " the input stops it: take them off."
    ),
    proven="parsed by blark; its ST is that of `st`, and executed",
    unproven="import into a vendor's tool",
)
