"""With which version and at which commit each page was made."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from .by_hand import judged_commit
from .catalogue import PAGES, Page
from .commit import CHANGED, ROOT, commit
from .footer import Footer, footer_of, release
from .publish import version


@dataclass(frozen=True)
class Age:
    """A page beside the tree of today; `judged` is the commit that its words by hand were written for."""

    page: Page
    footer: Footer | None
    commit: str
    version: str
    judged: str | None = None

    @property
    def unread(self) -> bool:
        """Whether it holds words by hand that were written for another run."""
        return self.footer is not None and self.judged not in (None, self.footer.commit)

    @property
    def fresh(self) -> bool:
        """Whether it was made at this commit, with nothing changed."""
        return self.footer is not None and self.footer.commit == self.commit and not self.commit.endswith(CHANGED)

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
            return f"of version {self.footer.version}"
        return ("of this commit" if self.fresh else "of this version") + (", words older" if self.unread else "")


def age(page: Page, root: Path = ROOT) -> Age:
    """Read a page."""
    path = root / page.file
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return Age(page, footer_of(text), commit(root), version(root), judged_commit(text))


def oldest_first(pages: Iterable[Page] = PAGES, root: Path = ROOT) -> list[Age]:
    """All pages by their age; those that are not there come first."""
    return sorted((age(page, root) for page in pages), key=lambda one: (one.made, one.page.name))
