"""Unit: files that are read as one table, and the loops in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from lostmotion.files.one_tag import OneTag


@dataclass(frozen=True)
class Found:
    """A loop of a unit.

    Attributes
    ----------
    name : str
        By which it is read; empty: it is alone there.
    tag : str
        What the columns or the partition call it; empty: they do not say.
    columns : mapping of str to str
        Column or tag of each role.
    area : str
        By its partition.
    files : tuple of Path
        Those of the unit that hold it; empty: all.
    """

    name: str = ""
    tag: str = ""
    columns: Mapping[str, str] = field(default_factory=dict)
    area: str = ""
    files: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Unit:
    """What files hold.

    Attributes
    ----------
    files : tuple of Path
        A file, pieces of a table, or files of one tag each.
    loops : tuple of Found
    names : tuple of str
        Columns, or tags of a table of tags and values.
    why : str
        Why there is no loop, in one line.
    failed : bool
        Whether that is wrong, or by the nature of the files.
    one_tag : OneTag, optional
        It holds the values of one tag only: a loop is there together with others.
    """

    files: tuple[Path, ...]
    loops: tuple[Found, ...] = ()
    names: tuple[str, ...] = ()
    why: str = ""
    failed: bool = False
    one_tag: OneTag | None = None
