"""Why looks that disagree tell nothing, in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from lostmotion.diagnose.diagnosis import Diagnosis


class Looked(Protocol):
    """A look that was diagnosed."""

    @property
    def found(self) -> Diagnosis:
        """What was said."""
        ...


def about_looks(seen: Sequence[Looked]) -> str:
    """One sentence."""
    said = " and ".join(f"'{one.found.verdict}'" for one in seen)
    return f"stretches of the window disagree: {said}"
