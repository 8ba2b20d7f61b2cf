"""What is asked of the plant page: all of it stands in the address."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any
from urllib.parse import quote, urlencode

PER_PAGE = 50
MOST_PER_PAGE = 500
NO_AREA, NO_LABEL = "(no area)", "(no label)"  # what stands for an empty word in an address
SORTS = {  # name in the address: column, whether the largest comes first
    "priority": ("rank", False),
    "tag": ("tag", False),
    "area": ("area", False),
    "verdict": ("said", False),
    "size": ("size_percent", True),
    "sure": ("sure", True),
    "swing": ("power", True),
    "period": ("period", True),
    "harris": ("harris", False),
    "variability": ("variability", True),
    "travel": ("travel", True),
    "manual": ("manual", True),
    "limited": ("limited", True),
    "missing": ("missing", True),
}


@dataclass(frozen=True)
class Query:
    """State of the plant page.

    Attributes
    ----------
    run : int
        0: the last one.
    text : str
        Part of tag, area, type or names of columns.
    area, type, verdict, label, split, review : str
        Empty: all.
    new : bool
        Only loops with something new.
    sort : str
        Of SORTS.
    turned : bool
        The other way round.
    page, per : int
        Page from 1, and loops on one.
    """

    run: int = 0
    text: str = ""
    area: str = ""
    type: str = ""
    verdict: str = ""
    label: str = ""
    split: str = ""
    review: str = ""
    new: bool = False
    sort: str = "priority"
    turned: bool = False
    page: int = 1
    per: int = PER_PAGE

    @classmethod
    def of(cls, given: Mapping[str, str]) -> Query:
        """Query of an address; what cannot be understood is left out.

        Examples
        --------
        >>> Query.of({"area": "North", "page": "x", "sort": "nonsense", "new": "1"})
        Query(run=0, text='', area='North', ... new=True, sort='priority', turned=False, page=1, per=50)
        """
        found: dict[str, Any] = {}
        for one in fields(cls):
            if one.name in given:
                found[one.name] = _read(given[one.name], one.default)
        asked = cls(**{name: value for name, value in found.items() if value is not None})
        per = min(max(asked.per, 1), MOST_PER_PAGE)
        sort = asked.sort if asked.sort in SORTS else "priority"
        return replace(asked, sort=sort, per=per, page=max(asked.page, 1), run=max(asked.run, 0))

    def __getitem__(self, name: str) -> str:
        """Word of a filter, for templates."""
        return str(getattr(self, name))

    @property
    def filtered(self) -> bool:
        """Whether not all loops are meant."""
        return bool(self.text or self.new or any(getattr(self, name) for name in CHOICES))

    def words(self, **changes: Any) -> str:
        """As it stands in an address, "?.." or nothing; another filter or order begins at its first page."""
        if not changes:
            return self._words
        if "page" not in changes:
            changes["page"] = 1
        return replace(self, **changes)._words

    @cached_property
    def _words(self) -> str:
        """Once for the hundreds of links of a page."""
        named = ((name, getattr(self, name)) for name in NAMES)
        told = {k: int(v) if isinstance(v, bool) else v for k, v in named if v != getattr(PLAIN, k)}
        return f"?{urlencode(told)}" if told else ""

    def link(self, **changes: Any) -> str:
        """Address of the plant page."""
        return f"/{self.words(**changes)}"

    def loop(self, tag: str) -> str:
        """Address of the page of a loop, from which this state is found again."""
        return loop_address(tag, self.words())


CHOICES = ("area", "type", "verdict", "label", "split", "review")
PLAIN = Query()
NAMES = tuple(one.name for one in fields(Query))


PARTS = ("review", "study", "report.html")  # of the address of a loop


def loop_address(tag: str, words: str = "", part: str = "") -> str:
    """Address of the page of a loop, or of a `part` of it.

    Examples
    --------
    >>> loop_address("FIC-1/A 2%", "?run=3"), loop_address("..", part="review"), loop_address("A/study")
    ('/loops/FIC-1/A%202%25?run=3', '/loops//review?tag=..', '/loops/?tag=A%2Fstudy')
    """
    pieces = tag.split("/")
    folders = any(piece in ("", ".", "..") for piece in pieces)  # a browser would resolve them
    odd = folders or pieces[-1] in PARTS  # the address of a part of another loop
    path = "/loops/" + ("" if odd else quote(tag, safe="/")) + (f"/{part}" if part else "")
    if not odd:
        return path + words
    return f"{path}?tag={quote(tag, safe='')}" + (f"&{words[1:]}" if words else "")


def _read(text: str, like: Any) -> Any:
    """Value of the kind of another; None: it is none."""
    if isinstance(like, bool):
        return text not in ("", "0")
    if isinstance(like, int):
        return int(text) if text.isdecimal() and len(text) < 10 else None
    return text[:200]
