"""One BLAS thread: the matrices here are small, and threads that wait for each other cost up to ten times as much.

Many loops are worked on side by side by processes instead.
"""

from __future__ import annotations

import functools
import threading
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

P = ParamSpec("P")
R = TypeVar("R")
# The limit holds for the whole process, so one thread must not lift it under another; and threads that pass the
# interpreter to and fro between short kernels are slower than one after the other.
_ONE_AT_A_TIME = threading.RLock()


@functools.cache
def _controller() -> ThreadpoolController:
    return ThreadpoolController()


def one_thread(function: Callable[P, R]) -> Callable[P, R]:
    """Run `function` with one BLAS thread, and not beside another one of its sort."""

    @functools.wraps(function)
    def limited(*args: P.args, **kwargs: P.kwargs) -> R:
        with _ONE_AT_A_TIME, _controller().limit(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
