"""The last line of a page: when it was made, by which script, at which commit, with which version."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import date

UNKNOWN = "unknown"
_LINE = re.compile(
    r"\*Made on (\S+) by `(\S+)` at commit `(\w+\+?)` with version (\S+?)(?:, in (\d+) min(?:ute)?s?)?\.\*\n*\Z"
)


@dataclass(frozen=True)
class Footer:
    """What a page says of its making; `minutes` is None where that was not kept."""

    made: date
    script: str
    commit: str
    version: str
    minutes: int | None = None

    def __str__(self) -> str:
        took = "" if self.minutes is None else f", in {self.minutes} {'minute' if self.minutes == 1 else 'minutes'}"
        return f"*Made on {self.made} by `{self.script}` at commit `{self.commit}` with version {self.version}{took}.*"

    @property
    def release(self) -> tuple[int, ...]:
        """Version as numbers."""
        return release(self.version)


def release(version: str) -> tuple[int, ...]:
    """Version as numbers, so that 0.10 comes after 0.9."""
    return tuple(int(number) for number in re.findall(r"\d+", version))


def signed(text: str, footer: Footer) -> str:
    """A page with this footer, in the place of any other."""
    return f"{unsigned(text).rstrip()}\n\n{footer}\n"


def unsigned(text: str) -> str:
    """A page without its footer."""
    return _LINE.sub("", text)


def footer_of(text: str) -> Footer | None:
    """Footer of a page; None where it has none."""
    found = _LINE.search(text)
    if found is None:
        return None
    made, script, commit, version, minutes = found.groups()
    return Footer(date.fromisoformat(made), script, commit, version, int(minutes) if minutes else None)
