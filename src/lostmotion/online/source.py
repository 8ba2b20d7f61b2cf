"""Where the rows of a loop come from: a file that grows, or a server that tells what changes."""

from __future__ import annotations

from threading import Event
from typing import Any, Protocol

from lostmotion.files.grid import Rows
from lostmotion.files.layout import Layout


class RowSource(Protocol):
    """What a service needs of a source: rows in order, and the place reached."""

    @property
    def name(self) -> str:
        """For messages."""

    @property
    def layout(self) -> Layout | None:
        """What the rows are; None while that is not known."""

    @property
    def more(self) -> bool:
        """Rows are there that were not given yet."""

    @property
    def ended(self) -> bool:
        """No rows will come any more."""

    @property
    def position(self) -> dict[str, Any]:
        """Place reached, JSON-ready: all that is needed to go on behind the last row given."""

    def read(self, most: int) -> Rows:
        """Rows that are there, up to about `most`; with 0 as many as it takes to know the layout, and none of them."""

    def finish(self, most: int) -> Rows:
        """The same at the end."""

    def wait(self, seconds: float, stop: Event) -> None:
        """Wait until there may be more, `seconds` have passed, or `stop` is set."""
