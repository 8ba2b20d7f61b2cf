"""What went wrong with a store, in one line with the remedy; no password is ever shown."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy.engine import Engine
from sqlalchemy.exc import DBAPIError

from lostmotion.addresses import without_password
from lostmotion.errors import FileAccessError, LostMotionError

REASONS = (  # part of what a driver says, what it means, what to do
    ("database is locked", "one that is locked by another program", "close what has it open, or wait until it is done"),
    ("readonly", "one that is read-only", "check its permissions and those of its folder, or give another store"),
    ("read-only", "one that is read-only", "check its permissions, or give another store"),
    ("permission denied", "no permission to write", "ask for the right to write there, or give another store"),
    ("disk is full", "a full disk", "make room and start again: what was done is kept"),
    ("could not extend", "a full disk", "make room and start again: what was done is kept"),
    ("No space left", "a full disk", "make room and start again: what was done is kept"),
    ("not a database", "a file that is none", "give the store another name"),
    ("malformed", "one that is damaged", "take a copy of it from before, or begin a new one"),
    ("could not decode", "one that is damaged", "take a copy of it from before, or begin a new one"),
    ("unable to open", "none that can be opened", "check that its folder is there and may be written to"),
    ("authentication failed", "user or password refused", "check the address"),
    ("no password supplied", "no password", "check the address"),
    ("does not exist", "a server without this database", "make it with createdb, or check the address"),
    ("connection", "no connection", "check that the server runs and can be reached, and start again"),
)


def store_error(name: str, got: str, remedy: str, expected: str = "a store") -> FileAccessError:
    """Error of a store: "expected a store 'x', got y; do z"."""
    return FileAccessError(f"expected {expected} {without_password(name)!r}, got {without_password(got)}; {remedy}")


@contextmanager
def told(name: str) -> Iterator[None]:
    """Errors of the database inside become one line.

    Raises
    ------
    FileAccessError
    """
    try:
        yield
    except DBAPIError as error:
        raise explained(name, error) from None  # the error of a driver may show the password
    except UnicodeDecodeError:  # in what SQLite says of names that are none
        raise damaged(name) from None


@contextmanager
def content(name: str, engine: Engine, *more: type[Exception]) -> Iterator[None]:
    """What is wrong with rows that we have not written becomes one line; `more`: errors that they lead to here.

    Raises
    ------
    FileAccessError
    """
    wrong: tuple[type[Exception], ...] = (ValueError, *more)
    try:
        yield
    except LostMotionError:
        raise
    except driver_error(engine) as error:  # of rows that are fetched from it directly
        raise explained(name, error) from None
    except wrong as error:
        raise damaged(name) from error


def driver_error(engine: Engine) -> type[Exception]:
    """What the driver of the database raises."""
    found: type[Exception] = engine.dialect.loaded_dbapi.Error
    return found


def damaged(name: str) -> FileAccessError:
    """Error of a store whose content is none of ours."""
    return store_error(name, "one that is damaged", "take a copy of it from before, or begin a new one")


def explained(name: str, error: Exception) -> FileAccessError:
    """What a driver said, in words."""
    original = error.orig if isinstance(error, DBAPIError) else None
    said = str(original or error).strip().split("\n", maxsplit=1)[0]
    for part, got, remedy in REASONS:
        if part.lower() in str(original or error).lower():
            return store_error(name, got, remedy, "a store that can be used at")
    return store_error(name, f"{type(original or error).__name__}: {said}", "check the address", "an answer of")
