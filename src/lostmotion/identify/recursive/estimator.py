"""What every recursive estimator does, for those who use one: monitor, adaptive block, many loops at once."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self

import numpy.typing as npt

from lostmotion.identify.recursive.recursive_estimate import ChangeEvent, RecursiveEstimate, Trajectory

if TYPE_CHECKING:
    from lostmotion.identify.recursive.iv import RecursiveIV
    from lostmotion.identify.recursive.ml import RecursiveML


class RecursiveEstimator(Protocol):
    """Takes samples, gives an estimate at any time, and lives on in its bytes; see ``lm.RecursiveIV``.

    Results do not depend on how the samples are cut into calls, nor on saving between them; a refused sample changes
    nothing. ``tests/contract/test_recursive_estimators.py`` says what else is promised, and checks it.
    """

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""

    @property
    def samples(self) -> int:
        """Samples seen."""

    @property
    def started(self) -> bool:
        """Whether the first samples, from which it finds its start, have passed."""

    @property
    def estimate(self) -> RecursiveEstimate:
        """Present estimate; CANNOT_TELL before there is one."""

    def update(self, u: float, y: float) -> float:
        """Take one sample; return its prediction error."""

    def run(self, u: npt.ArrayLike, y: npt.ArrayLike, every: int = 1) -> Trajectory:
        """Take all samples of u and y (n,); keep every `every`-th estimate."""

    def to_bytes(self) -> bytes:
        """Whole state."""

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Estimator that continues bit by bit where that of the bytes stood."""


class WatchingEstimator(RecursiveEstimator, Protocol):
    """One that can watch a loop in service: samples may be missing or masked, and it tells changes."""

    @property
    def events(self) -> tuple[ChangeEvent, ...]:
        """Last changes, oldest first."""

    def run(self, u: npt.ArrayLike, y: npt.ArrayLike, every: int = 1, use: npt.ArrayLike | None = None) -> Trajectory:
        """Take all samples but those that are missing (NaN); do not learn from those without `use`."""

    def period(self) -> tuple[dict[str, float], dict[str, float], int] | None:
        """Break points and width from the samples since the last call alone, errors, number of samples."""


if TYPE_CHECKING:  # the type checker says so if one of ours does not
    OURS: tuple[type[RecursiveEstimator], type[WatchingEstimator]] = (RecursiveIV, RecursiveML)
