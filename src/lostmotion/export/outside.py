"""Text that others wrote (names of files, tags, reasons, notes) on its way into what machines read.

One function per language. Each is the last thing that touches the text, and lets through one line of printable ASCII
without the marks that begin or end a comment, a string or a pragma there. What is not let through is replaced by
something alike, so that a person still reads it.
"""

from __future__ import annotations

import unicodedata

LONGEST = 1000  # characters: a header is for people
ALIKE = str.maketrans(
    {"\\": "/", "*": "x", "'": "`", '"': "`", "{": "(", "}": ")", "[": "(", "]": ")", "<": "(", ">": ")", "$": "S"}
)
UNKNOWN = "."  # for what has nothing alike
LETTERS = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
EVERYWHERE = frozenset(f"{LETTERS} .,:;+-=_/()%")
CODE = EVERYWHERE | frozenset("!#&@^`|~?")


def anywhere(text: str) -> str:
    """Text for a language that is not known: letters, digits and ``.,:;+-=_/()%``, no ``--``, ``//`` or ``;;``.

    Examples
    --------
    >>> anywhere("FIC-101 --<b>? *)")
    'FIC-101 -(b). x)'
    """
    said = _allowed(text, EVERYWHERE)
    for mark in "-/;":
        while 2 * mark in said:
            said = said.replace(2 * mark, mark)
    return said


def structured_text(text: str) -> str:
    """Text for a comment of IEC 61131-3, also where a tool makes one of what stands in XML.

    Examples
    --------
    >>> structured_text("x *) END_VAR {pragma} 'y'")
    'x x) END_VAR (pragma) `y`'
    """
    return _allowed(text, CODE)


def scl(text: str) -> str:
    """Text for a comment of Siemens SCL, where ``#``, ``@`` and ``&`` mean something as well."""
    return _allowed(text, CODE - frozenset("#@&"))


def c99(text: str) -> str:
    r"""Text for a comment of C: no ``*``, no end of line by ``\`` and none by the trigraph ``??/``.

    Examples
    --------
    >>> c99("x *\\ int pwned; \\*.csv")
    'x x/ int pwned; /x.csv'
    """
    return _allowed(text, CODE - frozenset("?"))


def markdown(text: str) -> str:
    """Text for a page in Markdown: no HTML, links, code, tables or emphasis.

    Examples
    --------
    >>> markdown("<script> [a](b) | `c`")
    '(script) (a)(b) . .c.'
    """
    return _allowed(text, EVERYWHERE)


def _allowed(text: str, allowed: frozenset[str]) -> str:
    """One line of what is allowed; the last step looks at every sign alone, so that no two can make a third."""
    clear = unicodedata.normalize("NFKD", text[: 4 * LONGEST])
    line = " ".join("".join(sign for sign in clear if not unicodedata.combining(sign)).split())
    shown = line if len(line) <= LONGEST else f"{line[: LONGEST - 3]} .."
    return "".join(sign if sign in allowed else UNKNOWN for sign in shown.translate(ALIKE))
