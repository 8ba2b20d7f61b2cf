"""User of a server: from a file that nobody else can read, or from the environment; never shown."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.errors import FileAccessError, ParameterError
from lostmotion.files.schema import toml_of
from lostmotion.live.opcua.certificates import refuse_public

USER, PASSWORD = "LOSTMOTION_OPCUA_USER", "LOSTMOTION_OPCUA_PASSWORD"  # names of variables


class Secret:
    """Text that is given away by :meth:`reveal` alone: not by print, repr, format, pickle or a traceback."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def reveal(self) -> str:
        """Text itself, for the one call that needs it."""
        return self._text

    def __repr__(self) -> str:
        return "***"

    def __reduce__(self) -> Any:
        raise TypeError("a secret is not stored")


@dataclass(frozen=True)
class User:
    """Who asks the server: a name with a password, or a certificate with a key.

    Attributes
    ----------
    name : str
        Empty where the certificate says it.
    password : Secret, optional
    certificate, key : Path, optional
        X.509 identity; the key is PEM without a password, for its owner alone.
    """

    name: str = ""
    password: Secret | None = None
    certificate: Path | None = None
    key: Path | None = None


def user_from(path: Path | None) -> User | None:
    """User in a file; without one, in the environment; None: nobody, the server is asked as anonymous.

    Parameters
    ----------
    path : Path, optional
        TOML with ``user`` and ``password``, or ``certificate`` and ``key`` (names of files beside it); mode 0600.

    Raises
    ------
    FileAccessError
        The file cannot be read, or others can read it.
    ParameterError
        It holds something else; only one of a pair is there.
    """
    if path is not None:
        return _of_file(path)
    name, password = os.environ.get(USER, ""), os.environ.get(PASSWORD, "")
    if bool(name) != bool(password):
        raise ParameterError.expected(f"{USER} and {PASSWORD}", "one of them", "set both, or neither")
    return User(name, Secret(password)) if name else None


def _of_file(path: Path) -> User:
    refuse_public(path)
    try:
        held = toml_of(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise FileAccessError(f"expected a readable file {path}, got {error.strerror}; check the path") from error
    except ValueError:  # what is wrong with it may hold the password
        held = {}
    given = {name for name, value in held.items() if isinstance(value, str) and value}
    if given != set(held) or given not in ({"user", "password"}, {"certificate", "key"}):
        wanted = 'user = ".." and password = "..", or certificate = ".." and key = ".."'
        raise ParameterError.expected(f"TOML with {wanted} in {path}", "something else", "write these two lines")
    if "user" in given:
        return User(held["user"], Secret(held["password"]))
    key = path.parent / held["key"]
    refuse_public(key)
    return User(certificate=path.parent / held["certificate"], key=key)
