"""What a supervisor needs of a controller: named values, read and written. OPC UA is one, a simulated PLC another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Protocol

from lostmotion.errors import LostMotionError


class LinkError(LostMotionError):
    """A read or a write that did not happen, or of which nobody knows whether it did."""


class Link(Protocol):
    """A supervised block, wherever it runs; names are those of its inputs and outputs, in lower case."""

    def read(self, names: Iterable[str]) -> Mapping[str, float]:
        """Present values of inputs and outputs.

        Raises
        ------
        LinkError
            One of them cannot be had, or is not of good quality.
        """
        ...

    def write(self, values: Mapping[str, int]) -> None:
        """Write whole numbers to inputs, in the order of `values`, once.

        Raises
        ------
        LinkError
            One was refused, or nobody knows: it is never tried again.
        """
        ...
