"""Where dropped files lie, and what was done with them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path


class Desk:
    """Workspace of a page.

    Parameters
    ----------
    keep : Path, optional
        Folder that stays; None: a temporary one, which :meth:`close` removes.
    files : sequence of str
        Files that are opened where they are, from the command line.
    """

    def __init__(self, keep: Path | None = None, files: Sequence[str] = ()) -> None:
        self.keep, self.files = keep, tuple(files)

    def close(self) -> None:
        """End what runs, and remove what is not kept."""
