"""Exported ST with one thing wrong: what a translator could get wrong, and a replay must catch."""

import re

SWAPS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "=": "<>", "<>": "=", "+": "-", "-": "+", "*": "/", "AND": "OR",
    "OR": "AND", "MIN": "MAX", "MAX": "MIN", "TRUE": "FALSE", "FALSE": "TRUE", "NOT": "", "ABS": "", "0.0": "1.0",
}  # fmt: skip
TOKEN = re.compile(r"\(\*.*?\*\)|:=|<>|<=|>=|\b0\.0\b|\b(?:AND|OR|MIN|MAX|TRUE|FALSE|NOT|ABS)\b|[-+*<>=]", re.S)


def mutants(text):
    """(what was changed, text) for every token of the body that can be swapped; a sign is dropped, not swapped."""
    start = text.rindex("END_VAR")
    for found in TOKEN.finditer(text, start):
        token = found[0]
        if token not in SWAPS:
            continue
        sign = token == "-" and text[found.start() - 1 : found.start()] in "(" or text[found.start() - 2 : found.start()] in (", ", "= ")
        new = "" if sign and token == "-" else SWAPS[token]
        line = text.count("\n", 0, found.start()) + 1
        whole = text.splitlines()[line - 1].strip()
        yield f"line {line}: {token!r} to {new!r} in {whole}", text[: found.start()] + new + text[found.end() :]
