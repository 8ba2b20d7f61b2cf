"""Parts of a page that is not finished: a script that was interrupted goes on where it was."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from .catalogue import PAGES, Page
from .commit import ROOT, commit
from .publish import STORE, replace_text

MOST_BYTES = 2**20  # of a part: rows of a table, no signals


def kept(name: str, key: str, work: Callable[[], Any], page: Page | None = None, root: Path = ROOT) -> Any:
    """Result of `work`, as JSON gives it back: tuples are lists.

    Parameters
    ----------
    name : str
        Of the page.
    key : str
        Which part of it, settings of the run included.
    work : callable
        Called where the same commit has not done this part before.
    """
    page = page or next(one for one in PAGES if one.name == name)
    path = _place(page, root) / f"{''.join(letter if letter.isalnum() else '-' for letter in key)}.json"
    if path.exists():
        return json.loads(path.read_text(encoding="utf-8"))
    text = json.dumps(work(), default=lambda number: number.item())
    if len(text) > MOST_BYTES:
        raise ValueError(f"expected {MOST_BYTES} bytes of the part {key!r} at most, got {len(text)}; keep rows only")
    replace_text(path, text)
    return json.loads(text)


@cache
def _place(page: Page, root: Path) -> Path:
    """Folder of the parts that today's commit has made; those of another one are removed."""
    place = root / STORE / page.name / commit(root)
    for other in place.parent.glob("*"):
        if other != place:
            shutil.rmtree(other)
    return place
