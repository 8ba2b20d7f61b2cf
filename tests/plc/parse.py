"""Parsers and schema that are not ours, run by the Python of .venv-plc: `parse.py FILE ..`, exit 1 and why.

.st: blark and tree-sitter; .TcPOU: blark; .xml: the schema of PLCopen TC6 v2.01.
"""

import sys
from pathlib import Path

import tree_sitter
import tree_sitter_iec61131_3_st
from blark.parse import parse
from lxml import etree

SCHEMA = Path(sys.prefix) / "tc6_xml_v201.xsd"


def with_blark(path):
    results = list(parse(path))
    if not results:
        return ["nothing found"]
    faults = [str(result.exception) for result in results if result.exception is not None]
    return faults or [f"not transformed: {result.filename}" for result in results if not result.transform().items]


def with_tree_sitter(path):
    language = tree_sitter.Language(tree_sitter_iec61131_3_st.language())
    tree = tree_sitter.Parser(language).parse(path.read_bytes())
    faults, open_ = [], [tree.root_node]
    while open_:
        node = open_.pop()
        if node.is_error or node.is_missing:
            faults.append(f"line {node.start_point[0] + 1}: {node.text[:60]!r}")
        open_ += node.children
    return faults


def with_schema(path):
    schema = etree.XMLSchema(etree.parse(SCHEMA))
    schema.validate(etree.parse(path))
    return [str(fault) for fault in schema.error_log]


CHECKS = {".st": (with_blark, with_tree_sitter), ".TcPOU": (with_blark,), ".xml": (with_schema,)}


def main(paths):
    bad = False
    for path in paths:
        for check in CHECKS[path.suffix]:
            faults = check(path)
            bad |= bool(faults)
            for fault in faults:
                print(f"{path.name}, {check.__name__}: {fault}")
    return int(bad)


if __name__ == "__main__":
    sys.exit(main([Path(argument) for argument in sys.argv[1:]]))
