"""Addresses of databases: told from paths, and shown without their password."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

_URL = re.compile(r"[A-Za-z][\w+.\-]*://")
_FILE_URL = re.compile(r"(sqlite:///)([^?]+)(.*)", re.IGNORECASE | re.DOTALL)
_PASSWORD = re.compile(r"(://[^:/@]*):(.*)@")
_SECRET = re.compile(r"((?:password|passwd|pwd|token|secret|sslpassword)=)[^&\s]*", re.IGNORECASE)


def is_url(source: Any) -> bool:
    """Whether a source is the address of a database, such as ``sqlite:///plant.db``."""
    return isinstance(source, str) and _URL.match(source) is not None


def absolute(source: str) -> str:
    """Address of a file, or of a database in one, for a process with another working folder; others as they are.

    Examples
    --------
    >>> absolute("postgresql://host/plant"), absolute("sqlite:////data/plant.db?mode=ro")
    ('postgresql://host/plant', 'sqlite:////data/plant.db?mode=ro')
    >>> absolute("plant.db") == str(Path("plant.db").absolute())
    True
    """
    if not is_url(source):
        return str(Path(source).absolute())
    found = _FILE_URL.fullmatch(source)
    if found is None or found[2].startswith(":"):  # in memory
        return source
    return f"{found[1]}{Path(found[2]).absolute()}{found[3]}"


def without_password(text: str) -> str:
    """Address, or any text that holds one, without its password.

    Examples
    --------
    >>> without_password("postgresql://reader:p@ss/w@host/plant"), without_password("a.csv")
    ('postgresql://reader:***@host/plant', 'a.csv')
    >>> without_password("mssql://host/plant?user=reader&password=abc")
    'mssql://host/plant?user=reader&password=***'
    """
    return _SECRET.sub(r"\1***", _PASSWORD.sub(r"\1:***@", text)) if "://" in text else text


def password_of(url: str) -> str:
    """Password in an address; empty where there is none."""
    found = _PASSWORD.search(url)
    return found.group(2) if found else ""
