"""Verbs that results offer and that higher layers carry out: plot, compensator, block, indices, summary.

A result lives low in the import order; what draws it or turns it into a block lives above. The higher layer
registers its function here when the package is imported, so nothing below imports anything above.
"""

from __future__ import annotations

from functools import singledispatch
from typing import Any

from lostmotion.errors import ParameterError


@singledispatch
def plot(result: Any, **options: Any) -> Any:
    """Figure of a result (registered by ``lostmotion.plot``)."""
    raise NotImplementedError(f"no figure for {type(result).__name__}")


@singledispatch
def compensator(model: Any, **options: Any) -> Any:  # noqa: ARG001  the registered ones take options
    """Ideal inverse of an actuator fault (registered by ``lostmotion.compensate``)."""
    remedy = "for stiction fit.block() knocks or makes two moves; for other faults mend the actuator"
    raise ParameterError.expected("a dead zone or a backlash, which have an inverse", type(model).__name__, remedy)


@singledispatch
def block(fit: Any, **options: Any) -> Any:  # noqa: ARG001  the registered ones take options
    """Compensating block with safeguards, as it runs in a PLC (registered by ``lostmotion.compensate``)."""
    raise ParameterError.expected("a fit to make a block from", type(fit).__name__, "use block_from_model()")


@singledispatch
def indices(result: Any, **options: Any) -> Any:
    """Indices of a response (registered by ``lostmotion.evaluate``)."""
    raise NotImplementedError(f"no indices for {type(result).__name__}")


@singledispatch
def summary(result: Any, **options: Any) -> str:
    """Text of a result (registered by ``lostmotion.report``)."""
    raise NotImplementedError(f"no summary for {type(result).__name__}")


@singledispatch
def remarks(result: Any) -> tuple[str, ...]:
    """Sentences about the data of a result (registered by ``lostmotion.report``)."""
    raise NotImplementedError(f"no remarks on {type(result).__name__}")
