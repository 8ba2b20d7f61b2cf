"""Background: one call in a process of its own, looked at while others go on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from lostmotion.errors import EngineError
from lostmotion.workers.pool import Outcome, Pool, WorkerDiedError

Result = TypeVar("Result")


class Background(Generic[Result]):
    """A call under way.

    Parameters
    ----------
    function : callable
        Of a module that a worker can import.
    *given
        Its arguments.
    seconds : float, optional
        After which it is stopped.
    memory, nicer : int
        As in :class:`Pool`.

    Raises
    ------
    EngineError
        No process can be started.
    """

    def __init__(
        self,
        function: Callable[..., Result],
        *given: object,
        seconds: float | None = None,
        memory: int = 0,
        nicer: int = 0,
    ) -> None:
        self._pool = Pool(1, seconds=seconds, memory=memory, nicer=nicer)
        self._outcome: Outcome | None = None
        self._pool.give(None, function, *given)

    @property
    def outcome(self) -> Outcome | None:
        """What came of it; None: it is under way."""
        try:
            self._outcome = self._outcome or self._pool.poll()
        except EngineError as error:  # its process does not start
            self._outcome = Outcome(None, error=error)
        if self._outcome is not None:
            self._pool.close()
        return self._outcome

    def close(self) -> None:
        """End it; harmless where that has been done."""
        self._pool.close()
        self._outcome = self._outcome or Outcome(
            None, error=WorkerDiedError("expected a result, got a call that was ended")
        )
