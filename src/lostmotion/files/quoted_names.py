"""Names of columns over several lines, as spreadsheets write them in quotes."""

from __future__ import annotations

import re

TOP = 1 << 16  # bytes in which the header is looked for
MOST_LINES = 10  # of one name
_BROKEN = re.compile(
    rb'(?:(?<=[;,\t\r\n])|^)"[^"\r\n]{0,200}(?:(?:\r\n|\r|\n)[^"\r\n]{0,200}){1,%d}"(?=[;,\t\r\n]|$)' % MOST_LINES
)
_BREAK = re.compile(rb"\r\n|\r|\n")


def joined(raw: bytes) -> bytes:
    r"""The text with blanks for the line ends inside of quotes near its top, which then follow as blank lines.

    So every row keeps the number of its line.

    Examples
    --------
    >>> joined(b'Time,"OP\n%","PV\nm3/h"\n0,1,2\n')
    b'Time,"OP %","PV m3/h"\n\n\n0,1,2\n'
    >>> joined(b'Time,"OP\n"\n"PV\n')
    b'Time,"OP "\n\n"PV\n'
    """
    top = raw[:TOP]
    if b'"' not in top:
        return raw
    found, at, owed = [], 0, b""
    for cell in _BROKEN.finditer(top):
        between, owed = _with_lines(raw[at : cell.start()], owed)
        breaks = _BREAK.findall(cell.group())
        found += [between, _BREAK.sub(b" ", cell.group())]
        at, owed = cell.end(), owed + b"".join(breaks)
    return b"".join([*found, *_with_lines(raw[at:], owed)]) if found else raw


def _with_lines(text: bytes, owed: bytes) -> tuple[bytes, bytes]:
    """A text with line ends that are owed behind its first one, and those that still are."""
    end = _BREAK.search(text)
    if not owed or end is None:
        return text, owed
    return text[: end.end()] + owed + text[end.end() :], b""
