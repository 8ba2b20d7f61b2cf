"""Packages that come with an extra, and the one sentence that says how to install a missing one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from lostmotion.errors import DataError

EXTRAS = {  # extra -> its purpose, its packages as they are imported
    "plot": ("figures", ("matplotlib",)),
    "control": ("python-control", ("control",)),
    "excel": ("spreadsheets", ("fastexcel",)),
    "matlab": ("MAT files of version 7.3", ("h5py",)),
    "sql": ("databases", ("sqlalchemy",)),
    "audit": ("the audit of a plant", ("sqlalchemy", "alembic")),
    "postgres": ("PostgreSQL", ("psycopg",)),
    "cluster": ("a Dask cluster", ("distributed", "dask")),
    "web": ("the page in the browser", ("starlette", "uvicorn", "python_multipart", "sqlalchemy", "alembic")),
    "live": ("OPC UA", ("asyncua", "cryptography")),
}


class MissingExtraError(DataError, ImportError):
    """A package of an extra is not installed; the message holds the command that installs it."""


@contextmanager
def extra(name: str = "") -> Iterator[None]:
    """Imports of the packages of an extra; one that is missing raises an error with the command that installs it.

    Parameters
    ----------
    name : str
        Extra of ``pyproject.toml``, a key of ``EXTRAS``. Empty: the first that has the missing package, except ``sql``,
        for whoever needs a database needs it for audits.

    Raises
    ------
    MissingExtraError
        A package of the extra is not installed. Other failed imports go through as they are.

    Examples
    --------
    >>> with extra():
    ...     raise ModuleNotFoundError("No module named 'distributed'", name="distributed")
    Traceback (most recent call last):
    ...
    lostmotion.extras.MissingExtraError: expected the package 'distributed' for a Dask cluster, got none; \
run: pip install "lostmotion[cluster]"
    """
    try:
        yield
    except MissingExtraError:
        raise
    except ImportError as error:
        package = (error.name or "").partition(".")[0]
        names = [name] if name else [one for one in EXTRAS if one != "sql"]
        found = next((one for one in names if package in EXTRAS[one][1]), None)
        if found is None:
            raise
        raise _missing(package, found) from error


def need_extra(name: str, instead: str = "") -> None:
    """Raise unless all packages of an extra can be found; for those that another process imports.

    Parameters
    ----------
    name : str
        A key of ``EXTRAS``.
    instead : str
        What else the user can do.

    Raises
    ------
    MissingExtraError
        One of them is missing.
    """
    missing = next((package for package in EXTRAS[name][1] if find_spec(package) is None), None)
    if missing is not None:
        raise _missing(missing, name, instead)


def _missing(package: str, name: str, instead: str = "") -> MissingExtraError:
    remedy = f'run: pip install "lostmotion[{name}]"' + (f", or {instead}" if instead else "")
    return MissingExtraError.expected(f"the package {package!r} for {EXTRAS[name][0]}", "none", remedy)
