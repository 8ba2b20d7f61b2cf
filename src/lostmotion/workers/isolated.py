"""Children of this program, started so that nothing of the working folder runs in them.

Python puts the working folder, or that of the script, before its own library; a file called ``types.py`` that lies
beside the records would run in every child that is started from there. Packages also read settings from it. So a child
starts with ``-P``, in an empty folder of the program's own, and finds packages where this process has them. Paths that
are given to a child must be absolute.

The pools of the standard library, loky and pebble do not start that way: they hand the child the module path and the
working folder of the parent, and import its main script again.
"""

from __future__ import annotations

import atexit
import os
import shutil
import stat
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

_EMPTY: list[Path] = []
SAFE_PATH = {"PYTHONSAFEPATH": "1"}  # the same as -P, for the children of a child
_THREADS = (
    "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "BLIS_NUM_THREADS",
    "NUMEXPR_NUM_THREADS", "POLARS_MAX_THREADS", "NUMBA_NUM_THREADS",
)  # fmt: skip
ONE_THREAD = dict.fromkeys(_THREADS, "1")  # read when NumPy, Numba and Polars are imported


def start(
    words: Sequence[str], environment: Mapping[str, str] | None = None, *, quiet: bool = False
) -> subprocess.Popen[bytes]:
    """Start this Python with pipes as standard input and output, deaf to Ctrl-C, which is for the parent.

    Parameters
    ----------
    words : sequence of str
        Behind the name of Python: options, and a script or module of ours. No text from outside is among them.
    environment : mapping, optional
        What the child has beside, or in place of, the environment of this process.
    quiet : bool
        Standard error goes nowhere.

    Raises
    ------
    OSError
        It cannot be started.
    """
    own_group: dict[str, Any] = {"start_new_session": True}
    if sys.platform == "win32":
        own_group = {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP}
    return subprocess.Popen(  # noqa: S603  this Python and a script or module of ours
        [sys.executable, "-P", *words],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL if quiet else None,
        bufsize=0,
        cwd=empty_folder(),
        env={**os.environ, **(environment or {}), **SAFE_PATH, "PYTHONPATH": os.pathsep.join(module_path())},
        **own_group,
    )


def empty_folder() -> Path:
    """Folder without files that only this user can write to; children share that of their parent."""
    while _EMPTY and not private(_EMPTY[-1]):  # what cleans folders of temporary files may have taken it
        _EMPTY.pop()
    if not _EMPTY:
        _EMPTY.append(Path(tempfile.mkdtemp(prefix="lostmotion-empty-")))
        atexit.register(_remove, _EMPTY[-1], os.getpid())
    return _EMPTY[-1]


def in_empty_folder() -> None:
    """Say, in a child, that it was started in such a folder."""
    _EMPTY.append(Path.cwd())


def private(folder: Path) -> bool:
    """Whether a folder is there, belongs to this user or the administrator, and nobody else can write to it."""
    try:
        seen = folder.lstat()
    except OSError:
        return False
    if sys.platform == "win32":  # temporary files and caches lie in the profile of the user
        return stat.S_ISDIR(seen.st_mode)
    return stat.S_ISDIR(seen.st_mode) and seen.st_uid in (0, os.getuid()) and not seen.st_mode & 0o022


def _remove(folder: Path, process: int) -> None:
    if os.getpid() == process:  # not at the end of a fork
        shutil.rmtree(folder, ignore_errors=True)


def module_path() -> list[str]:
    """Folders in which this process finds modules, without the one that Python has put first by itself.

    That one is the folder of the script, or the working folder. What PYTHONPATH or a program has named stays.
    """
    folders = [folder for folder in sys.path if os.path.isabs(folder)]  # noqa: PTH117  text, as Python has it
    if (first := put_first()) in folders:
        folders.reverse()
        folders.remove(first)
        folders.reverse()
    home = str(Path(__file__).parents[2])
    return folders if home in folders else [*folders, home]


def put_first() -> str:
    """Folder that Python has put before its own library; empty: none."""
    main = sys.modules.get("__main__")
    script: str | None = getattr(main, "__file__", None)
    if sys.flags.safe_path or script is None:  # python -P; python -c, where it is the one without a name
        return ""
    if getattr(main, "__spec__", None) is not None:  # python -m
        return _STARTED_IN
    return os.path.dirname(os.path.realpath(script))  # noqa: PTH120


_STARTED_IN = ""  # as Python writes it into its module path for `python -m`
with suppress(OSError):
    _STARTED_IN = os.getcwd()  # noqa: PTH109
