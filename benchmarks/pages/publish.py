"""Writing a page: whole or not at all, with the line that says at which commit."""

from __future__ import annotations

import shutil
import tempfile
import time
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from .by_hand import carried
from .catalogue import PAGES, Page
from .commit import ROOT, commit
from .footer import Footer, signed

BEGUN, AT = time.time(), commit()  # of the script that imports this
MIXED = "mixed"
STORE = Path(".cache", "pages")  # parts of pages that are not finished


def publish(path: Path, text: str, pages: Iterable[Page] = PAGES, root: Path = ROOT) -> None:
    """Write a page of the catalogue.

    Where the tree is at another commit than when the script began, nobody knows what was measured: it says "mixed".
    """
    page = next((page for page in pages if root / page.file == path.resolve()), None)
    if page is None:
        raise LookupError(f"expected a page of the catalogue, got {path}; add it to benchmarks/pages/catalogue.py")
    minutes = max(round((time.time() - BEGUN) / 60.0), 1)
    now = commit(root)
    at = now if root != ROOT or now == AT else MIXED
    footer = Footer(datetime.now(UTC).date(), page.script, at, version(root), minutes)
    old = path.read_text(encoding="utf-8") if path.exists() else ""
    replace_text(path, signed(carried(text, old, footer.commit), footer))
    forget_parts(page.name, root)


def forget_parts(name: str, root: Path = ROOT) -> None:
    """Remove what was kept of a page that is now written."""
    shutil.rmtree(root / STORE / name, ignore_errors=True)


def version(root: Path = ROOT) -> str:
    """Version of the package in this tree."""
    lines = (root / "src" / "lostmotion" / "__init__.py").read_text(encoding="utf-8").splitlines()
    return next(line.split('"')[1] for line in lines if line.startswith("__version__"))


def replace_text(path: Path, text: str) -> None:
    """Write a file so that it is never there by half."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", dir=path.parent, delete=False, encoding="utf-8", suffix=".part") as stream:
        part = Path(stream.name)
        try:
            stream.write(text)
        except BaseException:
            part.unlink()
            raise
    part.chmod(0o644)
    part.replace(path)
