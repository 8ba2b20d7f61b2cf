"""PLCopen XML (TC6 v2.01): interface as elements, the ST of :mod:`structured_text` as body."""

from __future__ import annotations

from lostmotion.export import structured_text
from lostmotion.export.frame import render
from lostmotion.export.source import Source

VERIFIED = (
    "valid by the schema tc6_xml_v201; the ST inside is compiled and executed in the tests of lostmotion and compared "
    "with the simulated block; not verified in the vendor's tool."
)


def files(source: Source) -> dict[str, str]:
    """The block as one PLCopen XML file."""
    declared, body = structured_text.parts(source)
    text = render(
        "plcopen.xml.j2",
        name=source.name,
        date=source.date,
        header=source.header(VERIFIED),
        rows=declared.rows,
        body="\n".join(body) + "\n",
    )
    return {f"{source.name}.xml": text}
