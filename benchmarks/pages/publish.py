"""Writing a page: whole or not at all, with the line that says from which source it is."""

from __future__ import annotations

import shutil
import sys
import tempfile
import time
from collections.abc import Iterable
from datetime import UTC, datetime
from pathlib import Path

from .by_hand import carried
from .catalogue import PAGES, Page
from .footer import Footer, signed
from .sources import ROOT, digest, sources

BEGUN = time.time()  # of the script that imports this
MIXED = "mixed"
STORE = Path(".cache", "pages")  # parts of pages that are not finished


def publish(path: Path, text: str, pages: Iterable[Page] = PAGES, root: Path = ROOT) -> None:
    """Write a page of the catalogue.

    Where a file that the page depends on was changed while the script ran, nobody knows what was measured: the page
    then says "mixed" and is stale from the beginning.
    """
    page = next((page for page in pages if root / page.file == path.resolve()), None)
    if page is None:
        raise LookupError(f"expected a page of the catalogue, got {path}; add it to benchmarks/pages/catalogue.py")
    minutes = max(round((time.time() - BEGUN) / 60.0), 1)
    footer = Footer(datetime.now(UTC).date(), page.script, source(page, root, BEGUN), version(root), minutes)
    old = path.read_text(encoding="utf-8") if path.exists() else ""
    replace_text(path, signed(carried(text, old, footer.source), footer))
    forget_parts(page.name, root)


def forget_parts(name: str, root: Path = ROOT) -> None:
    """Remove what was kept of a page that is now written."""
    shutil.rmtree(root / STORE / name, ignore_errors=True)


def source(page: Page, root: Path = ROOT, begun: float | None = None) -> str:
    """Digest of all that a page depends on; "mixed" where some of it is younger than `begun`."""
    script, what = root / page.script, (page.also, root, page.without)
    if begun is not None:
        read = [name for name in page.without if _module(name) in sys.modules]
        if read:
            print(f"{page.file}: its script reads files ({', '.join(read)}); say so: reads=True", file=sys.stderr)
            return MIXED
        younger = [path for path in sources(script, *what) if path.stat().st_mtime > begun]
        if younger:
            names = ", ".join(path.relative_to(root).as_posix() for path in younger)
            print(f"{page.file}: changed while the script ran: {names}", file=sys.stderr)
            return MIXED
    return digest(script, *what)


def _module(file: str) -> str:
    return ".".join(Path(file).with_suffix("").parts[1:])


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
