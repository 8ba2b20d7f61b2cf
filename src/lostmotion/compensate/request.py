"""A request to a supervised block, as whole numbers with their checksum; plain Python beside the kernel."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from lostmotion.compensate.supervised import KEY_MODULUS
from lostmotion.errors import ParameterError

LARGEST = 4_000_000
WEIGHT = 31


@dataclass(frozen=True)
class Request:
    """What a supervisor asks for: factor, first and second width in whole numbers of the block's resolution."""

    id: int
    factor: int
    first: int
    second: int
    key: int = 0

    def __post_init__(self) -> None:
        for name, value in self.to_dict().items():
            if not isinstance(value, int) or abs(value) > LARGEST:
                raise ParameterError.expected(f"a whole {name} within +-{LARGEST}", repr(value), "see the resolution")
        if self.id < 1 or not 0 <= self.key < KEY_MODULUS:
            raise ParameterError.expected(f"id >= 1, 0 <= key < {KEY_MODULUS}", (self.id, self.key), "give others")

    @property
    def checksum(self) -> int:
        """Sum that the block works out as well."""
        total = self.key
        for number in (self.id, self.factor, self.first, self.second):
            total = (WEIGHT * total + (number + LARGEST) % KEY_MODULUS) % KEY_MODULUS
        return total

    def to_dict(self) -> dict[str, int]:
        """The numbers by name, without the key."""
        return {"id": self.id, "factor": self.factor, "first": self.first, "second": self.second}

    @property
    def values(self) -> Mapping[str, int]:
        """Inputs of the block in the order in which they are written: the id last, for it makes the request."""
        return {
            "asked_factor": self.factor,
            "asked_first": self.first,
            "asked_second": self.second,
            "checksum": self.checksum,
            "request_id": self.id,
        }
