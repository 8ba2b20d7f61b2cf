"""How old each page is, and which are stale."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from .by_hand import judged_source
from .catalogue import PAGES, Page
from .footer import Footer, footer_of, release
from .publish import source, version
from .sources import ROOT


@dataclass(frozen=True)
class Age:
    """A page beside the source of today; `judged` is the source that its words by hand were written for."""

    page: Page
    footer: Footer | None
    source: str
    version: str
    judged: str | None = None

    @property
    def unread(self) -> bool:
        """Whether it holds words by hand that were written for another run."""
        return self.footer is not None and self.judged not in (None, self.footer.source)

    @property
    def stale(self) -> bool:
        """Whether it was made from another source, or is not there."""
        return self.footer is None or self.footer.source != self.source

    @property
    def behind(self) -> bool:
        """Whether it was made before the present version, or nobody knows by what."""
        return self.footer is None or self.footer.release < release(self.version)

    @property
    def made(self) -> date:
        """Day of its making; the first of all days where it is not there."""
        return date.min if self.footer is None else self.footer.made

    @property
    def minutes(self) -> float:
        """Expected minutes of making it again: those of the last time, where they are known."""
        return self.page.minutes if self.footer is None or self.footer.minutes is None else self.footer.minutes

    @property
    def state(self) -> str:
        """In a few words."""
        if self.footer is None:
            return "not made"
        if self.behind:
            return f"stale, of version {self.footer.version}"
        return ("stale" if self.stale else "fresh") + (", words older" if self.unread else "")


def age(page: Page, root: Path = ROOT) -> Age:
    """Read a page and the source that it depends on."""
    path = root / page.file
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return Age(page, footer_of(text), source(page, root), version(root), judged_source(text))


def oldest_first(pages: Iterable[Page] = PAGES, root: Path = ROOT) -> list[Age]:
    """All pages by their age; those that are not there come first."""
    return sorted((age(page, root) for page in pages), key=lambda one: (one.made, one.page.name))
