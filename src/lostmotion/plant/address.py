"""Where the data of a loop lie, as one line: files, the loop's name inside them, several records one after another."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass

_MARKS = {"%": "%25", "|": "%7C", "&": "%26", "#": "%23", "\n": "%0A", "\r": "%0D"}  # % first
_UNSHOWN = re.compile("%u([0-9a-f]{4})|%U([0-9a-f]{8})")  # a sign that no terminal and no list of loops should meet


@dataclass(frozen=True)
class Place:
    """One record of a loop.

    Attributes
    ----------
    files : tuple of str
        Read as one table: a file, the pieces of a Parquet folder, or files of one tag each.
    loop : str
        What the loop is called inside; empty: it is alone there, or its columns are named.
    """

    files: tuple[str, ...]
    loop: str = ""


def written(places: Sequence[Place]) -> str:
    """Places as one line: ``file``, ``file#loop``, ``file&file`` (one record), ``place|place`` (one after another).

    Examples
    --------
    >>> written([Place(("plant.csv",), "FIC101")]), written([Place(("a#1.csv", "b.csv")), Place(("c.csv",))])
    ('plant.csv#FIC101', 'a%231.csv&b.csv|c.csv')
    """
    return "|".join(_written(place) for place in places)


def _written(place: Place) -> str:
    files = "&".join(_marked(file) for file in place.files)
    return f"{files}#{_marked(place.loop)}" if place.loop else files


def parsed(line: str) -> tuple[Place, ...]:
    """Places of :func:`written`.

    Examples
    --------
    >>> parsed("a%231.csv&b.csv|c.csv#FIC101")
    (Place(files=('a#1.csv', 'b.csv'), loop=''), Place(files=('c.csv',), loop='FIC101'))
    """
    return tuple(_parsed(one) for one in line.split("|")) if line else ()


def _parsed(line: str) -> Place:
    files, _, loop = line.partition("#")
    return Place(tuple(_plain(file) for file in files.split("&")), _plain(loop))


def _marked(name: str) -> str:
    for sign, code in _MARKS.items():
        name = name.replace(sign, code)
    return "".join(sign if sign.isprintable() else _code(ord(sign)) for sign in name)


def _code(number: int) -> str:
    return f"%u{number:04x}" if number < 1 << 16 else f"%U{number:08x}"


def _plain(name: str) -> str:
    name = _UNSHOWN.sub(lambda found: _sign(int(found[1] or found[2], 16), found[0]), name)
    for sign, code in reversed(_MARKS.items()):
        name = name.replace(code, sign)
    return name


def _sign(number: int, otherwise: str) -> str:
    return chr(number) if number <= sys.maxunicode else otherwise
