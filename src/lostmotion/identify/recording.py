"""How a loop was recorded: a longer record tells it better than its parts, in which it is the same."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lostmotion.identify.foreknown import Foretold
from lostmotion.identify.unseen_moves import Unseen

if TYPE_CHECKING:
    from lostmotion.identify.data import IdentificationData


@dataclass(frozen=True)
class Recording:
    """What a part is to take from the whole.

    Attributes
    ----------
    unseen : Unseen
        What OP does between the rows.
    foretold : Foretold
        What OP says of PV beyond its past.
    """

    unseen: Unseen
    foretold: Foretold

    @classmethod
    def of(cls, data: IdentificationData) -> Recording:
        """As this data tells it."""
        return cls(data.unseen, data.foretold)
