"""C99: a header and a source, no library but fabs, no global state."""

from __future__ import annotations

import re
from collections.abc import Mapping

from lostmotion.export import outside
from lostmotion.export.dialects.assemble import Declaration, assemble
from lostmotion.export.dialects.dialect import Dialect
from lostmotion.export.frame import declare, render
from lostmotion.export.printer import Printer, Syntax
from lostmotion.export.source import Source

VERIFIED = (
    "compiled with gcc -std=c99 -Wall -Wextra -Werror -ffp-contract=off, executed and compared with the simulated "
    "block in the tests of lostmotion. Keep IEEE arithmetic: no -ffast-math."
)

TYPES = {"double": "LREAL", "float": "REAL", "bool": "BOOL", "int32_t": "DINT"}


def files(source: Source) -> dict[str, str]:
    """Header and source of the block."""
    double = source.real == "lreal"
    types = {"real": "double" if double else "float", "bool": "bool", "int": "int32_t"}
    declared = declare(source, source.tree, types, true="true", false="false")
    suffix = "" if double else "f"
    syntax = Syntax(
        operators={"=": "==", "<>": "!=", "and": "&&", "or": "||", "%": "%"},
        calls={
            "min": "lesser({0}, {1})",
            "max": "greater({0}, {1})",
            "abs": f"fabs{suffix}({{0}})",
            "to real": f"({types['real']})({{0}})",
            "to int": "(int32_t)({0})",
        },
        variable={"parameter": "p->{}", "state": "s->{}", "input": "i->{}", "output": "o->{}"},
        number_suffix=suffix,
        true="true",
        false="false",
        negation="!{}",
        assign="{} = {};",
        if_="if ({}) {{",
        elsif="}} else if ({}) {{",
        else_="} else {",
        end_if="}",
        remark="/* {} */",
    )
    body = Printer(syntax, declared.names).lines(source.tree.body, depth=1)
    context = {
        "name": source.name,
        "header": source.header(VERIFIED, outside.c99),
        "rows": declared.rows,
        "body": body,
        "real": types["real"],
        "suffix": suffix,
        "uses": "\n".join(body),
    }
    return {f"{source.name}.h": render("c99.h.j2", **context), f"{source.name}.c": render("c99.c.j2", **context)}


def restore(files: Mapping[str, str]) -> str:
    """Declarations from the structures of the header, the body of the step function line by line."""
    (name,) = {file.rpartition(".")[0] for file in files}
    header, text = (_below_remarks(files[f"{name}.{ending}"]) for ending in ("h", "c"))
    words = {"parameters": "VAR_INPUT", "inputs": "VAR_INPUT", "outputs": "VAR_OUTPUT", "state": "VAR"}
    defaults = re.findall(r"([^\s,{]+), /\* (\w+) \*/", text)
    known = {variable: value for value, variable in defaults}
    declarations: list[Declaration] = []
    for block, struct in re.findall(
        r"typedef struct \{\n(.*?)\} \w+?_(parameters|inputs|outputs|state);", header, re.S
    ):
        for kind, variable in re.findall(r"^ +(\w+) (\w+);", block, re.M):
            default = (
                re.sub(r"(?<=\d)f$", "", known.get(variable, "")).replace("true", "TRUE").replace("false", "FALSE")
            )
            declarations.append((words[struct], variable, TYPES[kind], default))
    body = text[text.index("_step(") :].split("{\n", 1)[1].rsplit("}", 1)[0]
    real = "LREAL" if "double" in header else "REAL"
    return assemble(name, declarations, "\n".join(_line(line, real) for line in body.splitlines()))


def _below_remarks(text: str) -> str:
    """What stands below the remarks at the top, whose words are no code."""
    found = re.search(r"^#", text, re.MULTILINE)
    return text[found.start() :] if found else text


def _line(line: str, real: str) -> str:
    line = re.sub(r"^(\s*)/\* (.*) \*/$", r"\1(* \2 *)", line)
    if line.lstrip().startswith("(*"):
        return line
    line = re.sub(r"^(\s*)\} else if \((.*)\) \{$", r"\1ELSIF \2 THEN", line)
    line = re.sub(r"^(\s*)if \((.*)\) \{$", r"\1IF \2 THEN", line)
    line = re.sub(r"^(\s*)\} else \{$", r"\1ELSE", line)
    line = re.sub(r"^(\s*)\}$", r"\1END_IF;", line)
    line = re.sub(r"[psio]->", "", line)
    line = line.replace("(double)", "DINT_TO_LREAL").replace("(float)", "DINT_TO_REAL")
    line = line.replace("(int32_t)", f"{real}_TO_DINT")
    line = line.replace("lesser(", "MIN(").replace("greater(", "MAX(")
    line = re.sub(r"\bfabsf?\(", "ABS(", line)
    line = re.sub(r"(?<=\d)f\b", "", line)
    line = re.sub(r"\btrue\b", "TRUE", re.sub(r"\bfalse\b", "FALSE", line))
    line = re.sub(r"!(?!=)", "NOT ", line)
    line = re.sub(r"(?<=\w) = ", " := ", line)
    return line.replace("%", "MOD").replace("&&", "AND").replace("||", "OR").replace("==", "=").replace("!=", "<>")


DIALECT = Dialect(
    name="c",
    title="C99",
    endings=("h", "c"),
    files=files,
    restore=restore,
    how_to_import=(
        "Add both files to the project; keep IEEE arithmetic (no -ffast-math). Set the inputs, call the step "
        "function once in each scan, read the outputs."
    ),
    proven=(
        "gcc `-std=c99 -Wall -Wextra -Werror -O2 -ffp-contract=off`, executed; once more with "
        "`-fsanitize=undefined,address`"
    ),
    unproven="other compilers",
)
