"""Verbs that results offer and that higher layers carry out: plot, compensator, block, indices, summary.

A result lives low in the import order; what draws it or turns it into a block lives above. The higher layer registers
its functions here when it is imported, and a verb imports its layer when it is first used: nothing below imports
anything above, and nothing is loaded before it is wanted.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import singledispatch, update_wrapper
from importlib import import_module
from typing import Any, Generic, TypeVar

from lostmotion.errors import ParameterError

Answer = TypeVar("Answer")


class Verb(Generic[Answer]):
    """Function of a result, chosen by the type of the result.

    Parameters
    ----------
    room : str
        Package that registers the functions; imported by name when the verb is used.
    fallback : callable
        What happens for a type that nobody registered.
    """

    def __init__(self, room: str, fallback: Callable[..., Answer]) -> None:
        self._room = room
        self._chosen = singledispatch(fallback)
        update_wrapper(self, fallback)

    def register(self, kind: type, function: Callable[..., Answer]) -> None:
        """Let `function` carry out the verb for results of type `kind`."""
        self._chosen.register(kind, function)

    def __call__(self, result: Any, **options: Any) -> Answer:
        """Carry it out."""
        import_module(self._room)
        return self._chosen(result, **options)


def _carried_out_by(room: str) -> Callable[[Callable[..., Answer]], Verb[Answer]]:
    return lambda fallback: Verb(room, fallback)


@_carried_out_by("lostmotion.plot")
def plot(result: Any, **options: Any) -> Any:
    """Figure of a result (registered by ``lostmotion.plot``)."""
    raise NotImplementedError(f"no figure for {type(result).__name__}")


@_carried_out_by("lostmotion.compensate")
def compensator(model: Any, **options: Any) -> Any:  # noqa: ARG001  the registered ones take options
    """Ideal inverse of an actuator fault (registered by ``lostmotion.compensate``)."""
    remedy = "for stiction fit.block() knocks or makes two moves; for other faults mend the actuator"
    raise ParameterError.expected("a dead zone or a backlash, which have an inverse", type(model).__name__, remedy)


@_carried_out_by("lostmotion.compensate")
def block(fit: Any, **options: Any) -> Any:  # noqa: ARG001  the registered ones take options
    """Compensating block with safeguards, as it runs in a PLC (registered by ``lostmotion.compensate``)."""
    raise ParameterError.expected("a fit to make a block from", type(fit).__name__, "use block_from_model()")


@_carried_out_by("lostmotion.evaluate.indices")
def indices(result: Any, **options: Any) -> Any:
    """Indices of a response (registered by ``lostmotion.evaluate.indices``)."""
    raise NotImplementedError(f"no indices for {type(result).__name__}")


@_carried_out_by("lostmotion.report.verbs")
def summary(result: Any, **options: Any) -> str:
    """Text of a result (registered by ``lostmotion.report.verbs``)."""
    raise NotImplementedError(f"no summary for {type(result).__name__}")


@_carried_out_by("lostmotion.report.verbs")
def frame(result: Any, **options: Any) -> Any:
    """A result as a data frame (registered by ``lostmotion.report.verbs``)."""
    raise NotImplementedError(f"no table of {type(result).__name__}")


@_carried_out_by("lostmotion.report.verbs")
def html(result: Any, **options: Any) -> str:
    """A result as HTML for notebooks (registered by ``lostmotion.report.verbs``)."""
    raise NotImplementedError(f"no HTML of {type(result).__name__}")


@_carried_out_by("lostmotion.report.verbs")
def remarks(result: Any, **options: Any) -> tuple[str, ...]:
    """Sentences about the data of a result (registered by ``lostmotion.report.verbs``)."""
    raise NotImplementedError(f"no remarks on {type(result).__name__}")
