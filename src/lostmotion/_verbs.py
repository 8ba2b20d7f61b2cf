"""Verbs that results offer and that higher layers carry out: plot, compensator, indices, summary.

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
    """Block that undoes an actuator fault (registered by ``lostmotion.compensate``)."""
    remedy = "other faults have no block yet: mend the actuator, or build on its inverse()"
    raise ParameterError.expected("a dead zone to compensate", type(model).__name__, remedy)


@singledispatch
def indices(result: Any, **options: Any) -> Any:
    """Indices of a response (registered by ``lostmotion.evaluate``)."""
    raise NotImplementedError(f"no indices for {type(result).__name__}")


@singledispatch
def summary(result: Any, **options: Any) -> str:
    """Text of a result (registered by ``lostmotion.report``)."""
    raise NotImplementedError(f"no summary for {type(result).__name__}")
