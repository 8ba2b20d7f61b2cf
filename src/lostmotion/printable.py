"""Text from outside -> text that a terminal only shows, and command lines that a shell takes as they are meant."""

from __future__ import annotations

import os
import re
import shlex
from collections.abc import Iterable

_DELETE = "\x7f"
_NO_LETTER = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")  # line breaks, controls, halves of signs

_KEPT = "\n\xa0\u2007\u2009\u202f"  # line ends, and the spaces inside numbers of many countries

_FORMULA = re.compile(r"'*[=+\-@\t\r＝＋－＠]")
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")


def printable(text: str) -> str:
    r"""Text whose lines are kept; all else that steers a terminal (colours, titles, direction of writing) written out.

    JSON stays JSON: of what it may hold only the sign for delete is written out, and that as JSON writes it.

    Examples
    --------
    >>> print(printable("FIC\x1b]0;x\x07\u202e-101\nm³/h"))
    FIC\x1b]0;x\x07\u202e-101
    m³/h
    """
    if text.replace("\n", "").isprintable():
        return text
    return "".join(sign if sign.isprintable() or sign in _KEPT else _written(sign) for sign in text)


def label(text: str) -> str:
    r"""Name in which line breaks, controls and bytes that are no text are written out: it stands in tables and files.

    Examples
    --------
    >>> print(label("FIC\n101"))
    FIC\n101
    """
    return _NO_LETTER.sub(lambda found: _written(found[0]), text)


def shell_line(words: Iterable[str]) -> str:
    r"""Words of a command, each quoted as bash, zsh and ksh need it, on one line that a terminal can show.

    Examples
    --------
    >>> print(shell_line(["check", "a b.csv", "it's\x1b[1m\n.csv"]))
    check 'a b.csv' $'it\'s\x1b[1m\x0a.csv'
    """
    return " ".join(map(shell_word, words))


def shell_word(word: str) -> str:
    """One word of :func:`shell_line`."""
    if word.isprintable():
        return f"'{word}'" if re.fullmatch(r"=[\w@%+=:,./-]*", word) else shlex.quote(word)  # zsh looks for a program
    signs = (f"\\{sign}" if sign in "\\'" else sign if sign.isprintable() else _bytes(sign) for sign in word)
    return f"$'{''.join(signs)}'"


def _bytes(sign: str) -> str:
    """Bytes of a sign in the name of a file, and so of half a sign that stands for a byte that is no text."""
    try:
        raw = os.fsencode(sign)
    except UnicodeEncodeError:
        raw = b"?"
    return "".join(f"\\x{byte:02x}" for byte in raw)


def _written(sign: str) -> str:
    return "\\u007f" if sign == _DELETE else sign.encode("unicode_escape").decode()


def cell_of(text: str) -> str:
    """Text as a cell that no spreadsheet takes for a formula, as OWASP advises; :func:`text_of` gives it back.

    Examples
    --------
    >>> cell_of("=1+1"), cell_of("-5.2"), cell_of("FIC101"), text_of(cell_of("'=x")), text_of("'n")
    ("'=1+1", '-5.2', 'FIC101', "'=x", "'n")
    """
    return f"'{text}" if _FORMULA.match(text) and not _NUMBER.fullmatch(text) else text


def text_of(cell: str) -> str:
    """Text that :func:`cell_of` has made a cell of."""
    return cell[1:] if cell.startswith("'") and _FORMULA.match(cell) else cell
