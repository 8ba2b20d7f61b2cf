"""Signals of a simulated loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lostmotion import _verbs
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief


@dataclass(frozen=True, eq=False, repr=False)
class LoopResponse(Brief):
    """Signals of a simulated loop, each of shape (n,).

    Attributes
    ----------
    time : seconds
    reference, output, measured : set point, true output, output with noise
    control, command, internal : controller output, command behind the compensator, internal variable x
    """

    time: FloatArray
    reference: FloatArray
    output: FloatArray
    measured: FloatArray
    control: FloatArray
    command: FloatArray
    internal: FloatArray
    dt: float

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (f"{len(self)} samples every {self.dt:g} s",)

    def __len__(self) -> int:
        return len(self.time)

    def indices(self, start: float = 0.0, stop: float | None = None) -> dict[str, float]:
        """Control variance eps1, mean absolute error eps2 (paper, eqs 32-33), travel and reversals of a track.

        Parameters
        ----------
        start, stop : float
            Track in seconds; default all.
        """
        result: dict[str, float] = _verbs.indices(self, start=start, stop=stop)
        return result

    def plot(self, **options: Any) -> Any:
        """Figure of PV and control (needs the extra ``lostmotion[plot]``).

        ``figure=`` draws into a matplotlib Figure or SubFigure, ``title=`` replaces that of the panel of PV.
        """
        return _verbs.plot(self, **options)
