"""The script of the user, in a worker that needs it: his own classes and functions may be part of a call.

It is imported only where a call names something that the worker does not find, behind everything else. A worker of a
command never does.
"""

from __future__ import annotations

import sys
from multiprocessing import spawn
from threading import Event
from typing import Any

from lostmotion.errors import EngineError
from lostmotion.workers.isolated import put_first

Script = tuple[str, dict[str, Any]]
_IMPORTS = Event()


def script() -> Script:
    """The script of this process: its folder, and how to import it."""
    said = spawn.get_preparation_data("worker")
    return put_first(), {name: said[name] for name in ("init_main_from_name", "init_main_from_path") if name in said}


def import_script(one: Script) -> None:
    """Make what a script defines known here, without what it does under ``if __name__ == "__main__":``."""
    folder, how = one
    if folder and folder not in sys.path:
        sys.path.append(folder)
    _IMPORTS.set()
    try:
        spawn.prepare(how)
    finally:
        _IMPORTS.clear()


def need_no_import() -> None:
    """Raise where workers are asked for by a script that a worker imports.

    Raises
    ------
    EngineError
    """
    if _IMPORTS.is_set():
        raise EngineError(
            "expected a script that can be imported, got one that starts workers then; "
            "do its work under if __name__ == '__main__':"
        )
