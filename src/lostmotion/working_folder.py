"""Settings that packages read from the working folder are not read: records of others lie there.

Numba takes ``.numba_config.yaml`` from it, when it is imported and before each compilation: a ``cache_dir`` in it would
have it unpickle files of others. Matplotlib takes ``matplotlibrc`` when it is imported: with ``text.usetex`` the titles
of figures would be run by TeX.
"""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.machinery import ModuleSpec, PathFinder
from typing import Any

NUMBA, NUMBA_FILE = "numba.core.config", ".numba_config.yaml"
MATPLOTLIB_FILE = "matplotlibrc"
_AWAY = threading.RLock()


@contextmanager
def without_settings(name: str) -> Iterator[None]:
    """Work in an empty folder, if there is a file of that name in the working folder.

    Notes
    -----
    The working folder is that of all threads, so they are elsewhere for as long; where there is no such file, never.
    """
    if not os.path.exists(name):  # noqa: PTH110  it is this text that packages look up
        yield
        return
    from lostmotion.workers.isolated import empty_folder  # noqa: PLC0415  in the rare case

    with _AWAY:
        before = os.getcwd()  # noqa: PTH109
        os.chdir(empty_folder())
        try:
            yield
        finally:
            os.chdir(before)


def import_matplotlib() -> None:
    """Import it with the settings of the user; where it is imported already it stays as it is."""
    if "matplotlib" not in sys.modules:
        with without_settings(MATPLOTLIB_FILE):
            import_module("matplotlib")


class _NumbaSettings:
    """Finds the module in which Numba reads its settings, and has it look at the environment alone."""

    def find_spec(self, fullname: str, path: Any, target: Any = None) -> ModuleSpec | None:
        """Spec of that module as it is, but for what is done when it is imported; None for all others."""
        spec = PathFinder.find_spec(fullname, path, target) if fullname == NUMBA else None
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def exec_module(module: Any) -> None:
                with without_settings(NUMBA_FILE):
                    execute(module)
                _use_environment_alone(module)

            spec.loader.exec_module = exec_module  # type: ignore[method-assign]
        return spec


def _use_environment_alone(config: Any) -> None:
    """No file is looked for from now on, and compiled code is kept where nobody else can write."""
    from lostmotion.compiled_folder import trusted_folder  # noqa: PLC0415  Numba takes half a second

    config._config_fname = os.devnull  # it is no file
    chosen = trusted_folder(config.CACHE_DIR)
    if chosen is not None:
        config.CACHE_DIR = str(chosen)


def ignore_numba_settings() -> None:
    """Have Numba look at the environment alone, whether it is imported already or not yet."""
    config = sys.modules.get(NUMBA)
    if config is None:
        sys.meta_path.insert(0, _NumbaSettings())
        return
    config._config_fname = os.devnull  # type: ignore[attr-defined]
    config.reload_config()
    _use_environment_alone(config)
