"""C99: a header and a source, no library but fabs, no global state."""

from __future__ import annotations

from lostmotion.export.frame import declare, render
from lostmotion.export.printer import Dialect, Printer
from lostmotion.export.source import Source

VERIFIED = (
    "compiled with gcc -std=c99 -Wall -Wextra -Werror -ffp-contract=off, executed and compared with the simulated "
    "block in the tests of lostmotion. Keep IEEE arithmetic: no -ffast-math."
)


def files(source: Source) -> dict[str, str]:
    """Header and source of the block."""
    double = source.real == "lreal"
    types = {"real": "double" if double else "float", "bool": "bool", "int": "int32_t"}
    declared = declare(source, source.tree, types, true="true", false="false")
    suffix = "" if double else "f"
    dialect = Dialect(
        operators={"=": "==", "<>": "!=", "and": "&&", "or": "||"},
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
    body = Printer(dialect, declared.names).lines(source.tree.body, depth=1)
    context = {
        "name": source.name,
        "header": source.header(VERIFIED),
        "rows": declared.rows,
        "body": body,
        "real": types["real"],
        "suffix": suffix,
        "uses": "\n".join(body),
    }
    return {f"{source.name}.h": render("c99.h.j2", **context), f"{source.name}.c": render("c99.c.j2", **context)}
