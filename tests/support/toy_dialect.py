"""A dialect that somebody else writes: the rows of ST in a list of "let" sentences, and back."""

import re

from lostmotion.export import Dialect
from lostmotion.export.dialects.assemble import assemble, only_file
from lostmotion.export.frame import declare
from lostmotion.export.printer import Printer, Syntax

SECTIONS = {"input": "VAR_INPUT", "parameter": "VAR_INPUT", "output": "VAR_OUTPUT", "state": "VAR", "local": "VAR"}


def files(source):
    types = {"real": source.real.upper(), "bool": "BOOL", "int": "DINT"}
    declared = declare(source, source.tree, types)
    syntax = Syntax(
        operators={"<>": "is not"},
        calls={
            "min": "least({0}, {1})", "max": "most({0}, {1})", "abs": "ABS({0})",
            "to real": f"DINT_TO_{types['real']}({{0}})", "to int": f"{types['real']}_TO_DINT({{0}})",
        },
        assign="let {} be {}", end_if="done", remark="-- {}",
    )  # fmt: skip
    lines = [f"-- {line}" for line in source.header("a toy.")]
    for section, word in SECTIONS.items():
        lines += [f"{word} {row.name} {row.type} {row.default}" for row in declared.rows[section]]
    body = Printer(syntax, declared.names).lines(source.tree.body)
    return {f"{source.name}.toy": "\n".join([*lines, "begin", *body, ""])}


def restore(files):
    name, text = only_file(files)
    head, body = re.sub(r"^ *--.*\n", "", text, flags=re.M).split("begin\n")
    body = re.sub(r"let (\w+) be (.*)", r"\1 := \2;", body).replace("done", "END_IF;").replace("is not", "<>")
    body = body.replace("least(", "MIN(").replace("most(", "MAX(")
    return assemble(name, [tuple(line.split(" ")) for line in head.splitlines()], body)


TOY = Dialect(
    name="toy",
    title="A tool that nobody has",
    endings=("toy",),
    files=files,
    restore=restore,
    how_to_import="Read it aloud.",
    proven="restored and executed",
    unproven="everything else",
)
