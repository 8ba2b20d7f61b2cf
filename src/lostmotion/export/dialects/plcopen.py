"""PLCopen XML (TC6 v2.01): interface as elements, the ST of :mod:`structured_text` as body."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree import ElementTree as ET

from lostmotion.export import outside
from lostmotion.export.dialects import structured_text
from lostmotion.export.dialects.assemble import assemble, only_file
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import render
from lostmotion.export.source import Source

XHTML = "{http://www.w3.org/1999/xhtml}"
TC6 = "{http://www.plcopen.org/xml/tc6_0201}"
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
        header=source.header(VERIFIED, outside.structured_text),
        rows=declared.rows,
        body="\n".join(body) + "\n",
    )
    return {f"{source.name}.xml": text}


def restore(files: Mapping[str, str]) -> str:
    """Declarations from the interface, the body as it is."""
    name, text = only_file(files)
    root = ET.fromstring(text.encode())  # noqa: S314  our own file
    declarations = []
    for element, word in (("inputVars", "VAR_INPUT"), ("outputVars", "VAR_OUTPUT"), ("localVars", "VAR")):
        for variable in root.iterfind(f".//{TC6}{element}/{TC6}variable"):
            kind = next(iter(variable.find(f"{TC6}type") or ())).tag.removeprefix(TC6)
            simple = variable.find(f"{TC6}initialValue/{TC6}simpleValue")
            default = "" if simple is None else simple.attrib["value"]
            declarations.append((word, variable.attrib["name"], kind, default))
    return assemble(name, declarations, root.findtext(f".//{TC6}ST/{XHTML}p") or "")


DIALECT = Dialect(
    name="plcopen",
    title="PLCopen XML, TC6 v2.01",
    endings=("xml",),
    files=files,
    restore=restore,
    how_to_import="CODESYS: Project, Import PLCopenXML. Other tools that read TC6 v2.01: their import.",
    proven="valid by the official schema; its ST is that of `st`, and executed",
    unproven="import into a vendor's tool",
)
