"""``lostmotion serve``."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lostmotion.addresses import is_url
from lostmotion.cli.closed_output import echo
from lostmotion.cli.options import number
from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.extras import need_extra

if TYPE_CHECKING:
    from lostmotion.web.server.serve import Door

SHORTEST = 20  # characters of a token that is kept in a file: 32 random bytes are 43
SQLITE = b"SQLite format 3\0"

Sources = Annotated[
    list[str] | None,
    typer.Argument(metavar="FILE", help="Records to look at, or the store of an audit (plant.db).", show_default=False),
]
Store = Annotated[str | None, number("--store", "Results of an audit: a file, or postgresql://user@host/plant.")]
Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port; 0: one that is free.")]
Bind = Annotated[str, typer.Option("--bind", help="Address; another than this machine's own needs --token-file.")]
TokenFile = Annotated[Path | None, number("--token-file", "File with the token that lets people in.")]
Open = Annotated[bool, typer.Option("--open/--no-open", help="Open the page in the browser.")]
ReadOnly = Annotated[bool, typer.Option("--read-only", help="Nothing can be dropped, reviewed or started.")]
Monitors = Annotated[
    list[str] | None,
    number("--monitor", "What `lostmotion online` or `live` prints, or its --state; as often as there are some."),
]
PublicUrl = Annotated[
    str | None, number("--public-url", "https://NAME of a proxy with TLS in front of the page; needs --token-file.")
]
Keep = Annotated[Path | None, number("--keep", "Folder for dropped files and results; default: gone at the end.")]


def serve(
    sources: Sources = None,
    store: Store = None,
    port: Port = 0,
    bind: Bind = "127.0.0.1",
    token_file: TokenFile = None,
    open_browser: Open = True,
    read_only: ReadOnly = False,
    keep: Keep = None,
    monitor: Monitors = None,
    public_url: PublicUrl = None,
) -> None:
    """Show a plant, its loops and dropped records as a page in the browser, on this machine only.

    Example: lostmotion serve --store plant.db

    The address that is printed lets one browser in; Enter prints a fresh one for another, and so does "Open in another
    browser" on the page. Programs come with the token of the first (docs/page.md). Without a file it opens a page on
    which records are dropped. Files stay on this machine, and are removed at the end unless --keep names a folder.

    Ctrl-C ends it, with exit code 0.
    """
    door = _door(bind, port, token_file, public_url)
    _serve(sources or [], store, door, open_browser, read_only, keep, tuple(monitor or ()))


def _serve(
    given: list[str], store: str | None, door: Door, open_browser: bool, read_only: bool, keep: Path | None,
    monitors: tuple[str, ...],
) -> None:  # fmt: skip
    from lostmotion.cli.enter import print_on_enter
    from lostmotion.web.desk.desk import Desk
    from lostmotion.web.page import Page
    from lostmotion.web.server.browser import open_in_browser
    from lostmotion.web.server.serve import serve as answer

    files, store = _sorted(given, store)
    if store is not None:
        _check(store)
    desk = None if read_only and not files else Desk(keep, files)

    def ready(address: str, fresh: Callable[[], str]) -> None:
        echo(address)
        sys.stdout.flush()
        if open_browser:
            open_in_browser(address)
        if door.token is None:
            print_on_enter(fresh)

    try:
        answer(Page(store, desk, monitors, read_only, fresh_addresses=door.token is None), door, ready)
    finally:
        if desk is not None:
            desk.close()


def _sorted(given: list[str], store: str | None) -> tuple[list[str], str | None]:
    """Files, and the store if one of them is one."""
    stores = [one for one in given if _is_store(one)]
    if len(stores) + (store is not None) > 1:
        raise ParameterError.expected("one store", f"{len(stores) + (store is not None)}", "start a page for each")
    files = [one for one in given if one not in stores]
    missing = [one for one in files if not is_url(one) and not Path(one).exists()]
    if missing:
        error = f"expected a file, got {missing[0]!r}, which does not exist; check the name"
        raise FileAccessError(error) from FileNotFoundError(missing[0])
    return files, store or next(iter(stores), None)


def _is_store(given: str) -> bool:
    if is_url(given):
        return given.startswith(("postgres", "sqlite"))
    try:
        with Path(given).open("rb") as file:
            return file.read(len(SQLITE)) == SQLITE
    except OSError:
        return False


def _check(store: str) -> None:
    """Refuse a store that cannot be shown before a page is opened."""
    from lostmotion.store.store import Store

    with Store(store, write=False):
        pass


def _door(bind: str, port: int, token_file: Path | None, public_url: str | None) -> Door:
    need_extra("web")
    from lostmotion.web.server.serve import Door, is_local, public_origin

    public = None if public_url is None else public_origin(public_url)
    if public is not None and token_file is None:
        raise ParameterError.expected("--token-file for a page that others reach", "none", "make one")
    if token_file is None and not is_local(bind):
        raise ParameterError.expected(
            f"--token-file for {bind}, which other machines reach", "none", "make one, or leave --bind out"
        )
    if not is_local(bind):
        echo(
            f"{bind} is open to other machines: whoever has the token sees all that is here, and reviews it. Nothing "
            "is encrypted: whoever reads the network reads the token too. Put it behind a tunnel (ssh -L) or a proxy "
            "with TLS.",
            err=True,
        )
    return Door(bind, port, None if token_file is None else _token(token_file), public)


def _token(path: Path) -> str:
    try:
        token = path.read_text(encoding="utf-8").strip()
        open_to_others = sys.platform != "win32" and path.stat().st_mode & 0o077
    except (OSError, UnicodeDecodeError) as error:
        raise FileAccessError(f"expected a file with a token, got {path}: {error}; write one into it") from error
    if open_to_others:
        raise FileAccessError(f"expected a token that only you can read, got {path}; do: chmod 600 {path}")
    if len(token) < SHORTEST or not all(sign.isalnum() or sign in "-_" for sign in token):
        raise ParameterError.expected(
            f"a token of {SHORTEST} letters, digits, - and _, or more",
            f"{len(token)} signs",
            'make one: python -c "import secrets; print(secrets.token_urlsafe())"',
        )
    return token
