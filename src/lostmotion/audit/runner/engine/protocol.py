"""What every engine can do: batches in, results out in any order; what kills its worker is found and left out."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any, Protocol

from lostmotion.errors import SetupError
from lostmotion.workers.child import one_line

__all__ = ["ALONE", "DIED", "Done", "Engine", "Lost", "Task", "Tried", "done", "one_line", "resolved"]

DIED = (
    "the worker process died on it, also when it was alone: out of memory, a crash in compiled code, or far over "
    "the time that a loop may take"
)
ALONE = 2  # deaths of a single item before it is given up: one may be somebody else's doing


@dataclass(frozen=True)
class Task:
    """What is done with each batch.

    Attributes
    ----------
    work : str
        ``module:function``, called with `common` and a tuple of items in a worker; gives one result for each item.
    common : object
        Goes to each worker once.
    """

    work: str
    common: Any = None


@dataclass(frozen=True)
class Done:
    """A batch, or a part of one.

    Attributes
    ----------
    items, results : tuple
        Equally long.
    """

    items: tuple[Any, ...]
    results: tuple[Any, ...]


@dataclass(frozen=True)
class Lost:
    """An item that cannot be done.

    Attributes
    ----------
    item : object
    why : str
        The same words whatever the engine.
    """

    item: Any
    why: str


class Engine(Protocol):
    """Workers. It is closed by whoever has opened it.

    Attributes
    ----------
    name : str
    workers : int
    """

    name: str
    workers: int

    def run(self, task: Task, batches: Iterable[tuple[Any, ...]]) -> Iterator[Done | Lost]:
        """Outcome of each item of each batch, once, in any order.

        Batches are asked for when workers need them, a few ahead.

        Raises
        ------
        EngineError
        """
        ...

    def close(self) -> None:
        """End the workers at once."""
        ...


@dataclass(frozen=True)
class Tried:
    """A batch on its way, and how often its worker has died while it was alone."""

    items: tuple[Any, ...]
    deaths: int = 0

    def after_death(self) -> tuple[list[Tried], list[Lost]]:
        """What is tried next: halves, until what kills is alone."""
        if len(self.items) > 1:
            return self._halves(), []
        if self.deaths + 1 >= ALONE:
            return [], [Lost(self.items[0], DIED)]
        return [Tried(self.items, self.deaths + 1)], []

    def after_error(self, why: str) -> tuple[list[Tried], list[Lost]]:
        """The same of work that raised; alone it would raise again."""
        return (self._halves(), []) if len(self.items) > 1 else ([], [Lost(self.items[0], why)])

    def _halves(self) -> list[Tried]:
        middle = len(self.items) // 2
        return [Tried(self.items[:middle]), Tried(self.items[middle:])]


def resolved(path: str) -> Any:
    """Function of ``module:function``.

    Raises
    ------
    SetupError
        It is not there.
    """
    module, _, name = path.partition(":")
    try:
        return getattr(import_module(module), name)
    except (ImportError, AttributeError) as error:
        raise SetupError(
            f"expected {path} on the worker, got {type(error).__name__}: {error}; install the same lostmotion there"
        ) from error


def done(task: Task, items: Sequence[Any]) -> tuple[Any, ...]:
    """Results of a batch, in a worker."""
    return tuple(resolved(task.work)(task.common, tuple(items)))
