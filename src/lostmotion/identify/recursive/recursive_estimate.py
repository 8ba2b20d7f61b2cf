"""What recursive estimators give back: the estimate after a sample, the way there, and the changes on it."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion import _verbs
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.brief import Brief, between
from lostmotion.errors import Status
from lostmotion.identify.named_estimate import NamedEstimate
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.summary import Summary


@dataclass(frozen=True, eq=False, repr=False)
class RecursiveEstimate(NamedEstimate):
    """What a recursive estimator knows after a sample; names as in ``HammersteinFit``.

    Attributes
    ----------
    samples : int
        Samples seen, missing ones included.
    noise : NoiseModel or None
        Output noise, where it is estimated.
    informed : dict of int
        Number of samples seen when the last information about each break point came; empty where not followed.
    """

    status: Status
    model: Hammerstein
    parameters: dict[str, float]
    covariance: FloatArray
    samples: int
    noise: NoiseModel | None = None
    informed: dict[str, int] | None = None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        size = getattr(self.nonlinearity, "size_name", None)
        interval = f" {between(*self.interval(size))}" if size in self.parameters else ""
        return f"{self.nonlinearity.kind}{interval}", self.status.name, f"{self.samples} samples"

    def summary(self) -> Summary:
        """Report as text, with as many digits as the standard errors allow."""
        return Summary(_verbs.text(self), self)

    def __str__(self) -> str:
        return self.summary()


@dataclass(frozen=True, eq=False, repr=False)
class Trajectory(Brief):
    """Estimates along a run.

    Attributes
    ----------
    samples : ndarray, shape (m,)
        Number of samples seen at each row.
    values : dict of ndarray
        left, right, left_slope, right_slope and the raw parameters theta (m, n); NaN before there is an estimate.
    errors : ndarray, shape (n,)
        Prediction errors of every sample; NaN where there is none.
    """

    samples: IntArray
    values: dict[str, FloatArray]
    errors: FloatArray

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (f"{self.errors.size} samples, {self.samples.size} estimates",)

    def __getitem__(self, name: str) -> FloatArray:
        return self.values[name]


@dataclass(frozen=True)
class ChangeEvent:
    """A parameter has moved.

    Attributes
    ----------
    sample : int
        Samples seen when it was raised.
    since : int
        Estimated sample of the change.
    name : str
        "left" or "right" (break points), "offset" (a load has come) or "process" (what lies behind the actuator).
    before, after : float
        Estimates, in engineering units; of the process the static gain from OP to PV beyond right.
    standard_error : float
        Of `after`, at the time of the event.
    """

    sample: int
    since: int
    name: str
    before: float
    after: float
    standard_error: float
