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
        word = found[0]
        if word not in SWAPS:
            continue
        before = text[max(0, found.start() - 3) : found.start()]
        sign = word == "-" and (before.endswith(("(", ", ", ":= ")))
        new = "" if sign else SWAPS[word]
        line = text.count("\n", 0, found.start()) + 1
        whole = text.splitlines()[line - 1].strip()
        yield f"line {line}: {word!r} to {new!r} in {whole}", text[: found.start()] + new + text[found.end() :]
