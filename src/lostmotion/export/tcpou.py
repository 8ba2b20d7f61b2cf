"""TwinCAT .TcPOU: the ST of :mod:`structured_text` in TwinCAT's XML."""

from __future__ import annotations

import uuid

from lostmotion.export import structured_text
from lostmotion.export.frame import render
from lostmotion.export.source import Source

VERIFIED = (
    "the ST inside is compiled and executed in the tests of lostmotion and compared with the simulated block, "
    "the file is parsed; not verified in the vendor's tool."
)


def files(source: Source) -> dict[str, str]:
    """The block as one .TcPOU; its Id follows from the text, so the same input gives the same file."""
    declared, body = structured_text.parts(source)
    header = source.header(VERIFIED)
    identity = uuid.uuid5(uuid.NAMESPACE_URL, "\n".join([source.name, *header, *body]))
    text = render("tcpou.xml.j2", name=source.name, id=identity, header=header, rows=declared.rows, body=body)
    return {f"{source.name}.TcPOU": text}
