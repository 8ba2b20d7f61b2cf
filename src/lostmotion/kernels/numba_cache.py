"""``njit`` of the kernels: compiled once for this processor, kept in the user's cache folder.

Numba keeps compiled code beside its source until that one file changes, although the code of its callees is compiled
into it; and not at all where an installation cannot be written. Here the folder is named after all sources of the
kernels and the version of Numba: code of older sources is never run, and several versions live side by side.
"""

from __future__ import annotations

import hashlib
import secrets
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import config
from platformdirs import user_cache_path

from lostmotion.kernels.compile_progress import count_compiled

Function = TypeVar("Function", bound=Callable[..., Any])

MAX_FOLDERS = 4  # of other sources or versions of Numba that are kept, 20 MB each: the latest ones
SOURCES = Path(__file__).parent
_PROCESS = secrets.token_hex(4)


def cache_folder(sources: Path = SOURCES) -> Path:
    """Folder of what is compiled from these sources; below ``NUMBA_CACHE_DIR`` where that is set."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(sources.rglob("*.py")):
        digest.update(path.relative_to(sources).as_posix().encode())
        digest.update(path.read_bytes())
    chosen = config.CACHE_DIR  # type: ignore[attr-defined]  # set by Numba from the environment
    base = Path(chosen) if chosen else user_cache_path("lostmotion", appauthor=False)
    return base / f"kernels-{digest.hexdigest()[:16]}"


def njit(folder: Path | None = None, **options: Any) -> Callable[[Function], Function]:
    """Return a decorator as ``numba.njit(cache=True)``, with the cache in `folder` (default: that of all kernels)."""
    place = FOLDER if folder is None else folder

    def compiled(function: Function) -> Function:
        chosen = config.CACHE_DIR  # type: ignore[attr-defined]
        config.CACHE_DIR = str(place)  # type: ignore[attr-defined]  # read while a function is decorated, then never again
        try:
            made: Function = numba.njit(cache=True, **options)(function)
        finally:
            config.CACHE_DIR = chosen  # type: ignore[attr-defined]
        _name_by_process(made)
        return made

    return compiled


def _name_by_process(function: Any) -> None:
    """Give this process file names of its own in the cache.

    Numba counts them up from 1: of two processes that compile one function at a time, for other types each, the index
    of one could name the code of the other, which would run from then on.
    """
    files = getattr(getattr(function, "_cache", None), "_cache_file", None)
    if files is not None:
        files._data_name_pattern = files._data_name_pattern.replace("{number", f"{_PROCESS}-{{number")


def prepare_folder(folder: Path) -> None:
    """Make the folder, and remove the oldest of others; where that fails Numba looks for another place by itself."""
    if folder.is_dir():
        return
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        others = [path for path in folder.parent.glob("kernels-*") if path != folder]
        for path in sorted(others, key=lambda path: path.stat().st_mtime)[:-MAX_FOLDERS]:
            shutil.rmtree(path, ignore_errors=True)


FOLDER = cache_folder()
if not config.DISABLE_JIT:  # type: ignore[attr-defined]
    prepare_folder(FOLDER)
    count_compiled()
