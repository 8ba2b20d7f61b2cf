"""Folder of what Numba has compiled. Numba unpickles its files, so nobody but this user may write there."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
import warnings
from pathlib import Path

from platformdirs import user_cache_path

from lostmotion.workers.isolated import private

VARIABLE = "NUMBA_CACHE_DIR"


def trusted_folder(chosen: str) -> Path | None:
    """Return the folder to be used in place of the one that was chosen, or of that of the user; None: that one.

    Parameters
    ----------
    chosen : str
        What NUMBA_CACHE_DIR says; empty: the cache folder of the user, which is closed to others here.

    Notes
    -----
    A chosen folder that others can write to is left as it is; a new one takes its place, so that kernels are compiled
    anew by each command, and a warning says so. The environment is changed then: workers compile nothing again.
    """
    folder = Path(chosen or user_cache_path("lostmotion", appauthor=False)).absolute()
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError:
        return None  # Numba looks for another place: beside its source
    if not chosen:
        _close(folder)
    if all(map(private, _folders(folder))):
        if chosen and not os.path.isabs(chosen):  # noqa: PTH117
            os.environ[VARIABLE] = str(folder)  # workers have another working folder
            return folder
        return None
    warnings.warn(f"others can write to {folder}: what is compiled is not kept there", RuntimeWarning, stacklevel=2)
    made = Path(tempfile.mkdtemp(prefix="lostmotion-compiled-"))
    os.environ[VARIABLE] = str(made)
    return made


def _folders(folder: Path) -> list[Path]:
    """With those of the kernels in it, and theirs."""
    return [folder.resolve(), *folder.glob("kernels-*"), *(one for one in folder.glob("kernels-*/*") if one.is_dir())]


def _close(folder: Path) -> None:
    """Close the user's own folder to others; what they could have written to is removed."""
    if sys.platform == "win32" or folder.stat().st_uid != os.getuid():
        return
    if folder.stat().st_mode & 0o077:
        opened = not all(map(private, _folders(folder)))
        folder.chmod(0o700)
        for one in folder.glob("kernels-*") if opened else ():
            shutil.rmtree(one, ignore_errors=True)
