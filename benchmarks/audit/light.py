"""Work of an engine that costs nothing: what is left is the engine."""

from __future__ import annotations

import os
import signal
import sys
from typing import Any


def double(common: int, items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Numbers times `common`; "kill" ends its worker, "raise" raises, "threads" says how many there are."""
    return tuple(_one(common, item) for item in items)


def _one(common: int, item: Any) -> Any:
    if item == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if item == "raise":
        raise ValueError("in\nthe work")
    if item == "threads":
        return {name: os.environ.get(name) for name in ("POLARS_MAX_THREADS", "NUMBA_NUM_THREADS", "OMP_NUM_THREADS")}
    if item == "loaded":
        return sorted({"numpy", "numba", "polars", "sqlalchemy"} & set(sys.modules))
    return common * item
