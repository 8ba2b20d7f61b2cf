"""Figures that a text quotes from a page, held against that page.

A quote is a piece of a sentence with ``{}`` where its figures stand. It must be found in the text, its figures must be
those of the page, and in the README every number outside code must belong to a quote or be given with its reason.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from .commit import ROOT
from .publish import replace_text
from .tables import NUMBER, PageText, QuoteError

Find = Callable[[PageText], Iterable[float]]
README = "README.md"
_HOLE = re.compile(r"\{(:[^}]*)?\}")
_CODE = re.compile(r"^```.*?^```|`[^`]*`|\]\([^)]*\)", flags=re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Quote:
    """A piece of a text whose figures are from a page.

    Attributes
    ----------
    says : str
        The piece, with a format such as ``{:.2f}`` where each figure stands.
    page : str
        Name of the page.
    find : callable
        Figures from that page, in the order of the piece; raises QuoteError where the words are no longer true.
    text : str
        Where it is quoted, relative to the repository.
    """

    says: str
    page: str
    find: Find
    text: str = README

    def figures(self, root: Path = ROOT) -> list[str]:
        """What should stand in the text."""
        found = self.find(_page(root / "docs" / f"{self.page}.md"))
        holes = [spec or "" for spec in _HOLE.findall(self.says)]
        return [f"{{{spec}}}".format(value) for spec, value in zip(holes, found, strict=True)]

    def places(self, text: str) -> list[re.Match[str]]:
        """Where the piece stands in a text, with any figures."""
        return list(self._pattern.finditer(text))

    @property
    def _pattern(self) -> re.Pattern[str]:
        words = []
        for word in self.says.split():
            literal = _HOLE.sub("\0", word)
            words.append(re.escape(literal).replace("\0", f"({NUMBER})"))
        return re.compile(r"\s+".join(words))


@cache
def _read(path: Path, _written: int) -> PageText:
    return PageText.read(path)


def _page(path: Path) -> PageText:
    return _read(path, path.stat().st_mtime_ns if path.exists() else 0)


def differences(quotes: Iterable[Quote], root: Path = ROOT, text: str | None = None) -> list[str]:
    """Sentences about every quote that is not there, not from its page, or not what its page says.

    `text` takes the place of the README.
    """
    return [line for quote in quotes for line in _differences(quote, root, text)]


def _differences(quote: Quote, root: Path, readme: str | None) -> Iterator[str]:
    known = readme if quote.text == README else None
    places = quote.places((root / quote.text).read_text(encoding="utf-8") if known is None else known)
    if not places:
        yield f"{quote.text} no longer says {quote.says!r}"
    try:
        right = quote.figures(root)
    except QuoteError as error:
        yield f"{quote.text}, {quote.says!r}: {error}"
        return
    for place in places:
        if list(place.groups()) != right:
            yield f"{quote.text} says {' '.join(place[0].split())!r}, docs/{quote.page}.md {', '.join(right)}"


def uncovered(text: str, quotes: Iterable[Quote], given: Iterable[str]) -> list[str]:
    """Numbers of a text outside code that belong to no quote and are not given, each with its line."""
    covered = [place.span() for quote in quotes for place in quote.places(text)]
    for piece in given:
        spans = [found.span() for found in re.finditer(r"\s+".join(map(re.escape, piece.split())), text)]
        covered += spans or [(-1, -1)]
    covered += [found.span() for found in _CODE.finditer(text)]
    left = [
        found
        for found in re.finditer(r"(?<![\w.])" + NUMBER, text)
        if not any(first <= found.start() and found.end() <= last for first, last in covered)
    ]
    return [f"{found[0]} in line {text.count(chr(10), 0, found.start()) + 1}" for found in left]


def absent(text: str, given: Iterable[str]) -> list[str]:
    """Pieces that are given for a text and do not stand in it."""
    plain = " ".join(text.split())
    return [piece for piece in given if " ".join(piece.split()) not in plain]


def excerpt_differences(text: str, excerpts: dict[str, str], root: Path = ROOT) -> list[str]:
    """Lines of code blocks, by the first line of the block, that are not lines of their page."""
    found = []
    for first, page in excerpts.items():
        lines = _page(root / "docs" / f"{page}.md").text.splitlines()
        block = text[text.index(f"```\n{first}\n") :].split("```")[1].splitlines()[2:]
        found += [f"docs/{page}.md has no line {line!r}" for line in block if line not in lines]
    return found


def shown(quotes: Iterable[Quote], root: Path = ROOT) -> Iterator[str]:
    """The manifest as lines: piece with its figures, page, commit of the page."""
    for quote in quotes:
        try:
            figures = iter(quote.figures(root))
            says = _HOLE.sub(lambda _, left=figures: next(left), quote.says)
        except QuoteError as error:
            says = f"{quote.says} ({error})"
        footer = _page(root / "docs" / f"{quote.page}.md").footer
        made = "unknown commit" if footer is None else f"commit {footer.commit}, {footer.made}, {footer.script}"
        yield f"{quote.text}: {says}\n    docs/{quote.page}.md, {made}"


def mend(quotes: Iterable[Quote], root: Path = ROOT) -> Iterator[str]:
    """Put the figures of the pages into the texts; what was changed, and what needs a hand."""
    for quote in quotes:
        path = root / quote.text
        text = path.read_text(encoding="utf-8")
        try:
            right = quote.figures(root)
        except QuoteError as error:
            yield f"by hand: {quote.text}, {quote.says!r}: {error}"
            continue
        for place in reversed(quote.places(text)):
            if list(place.groups()) != right:
                new = _filled(place, right)
                yield f"{quote.text}: {' '.join(place[0].split())!r} is now {' '.join(new.split())!r}"
                text = text[: place.start()] + new + text[place.end() :]
        replace_text(path, text)


def _filled(place: re.Match[str], figures: list[str]) -> str:
    """A piece as it stands, line breaks kept, with other figures."""
    text, start = place[0], place.start()
    for group in reversed(range(len(figures))):
        first, last = place.span(group + 1)
        text = text[: first - start] + figures[group] + text[last - start :]
    return text
