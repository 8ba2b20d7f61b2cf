"""What recursive estimators hand back: the present estimate, and the estimates along a run."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lostmotion.errors import Status
from lostmotion.identify.named_estimate import NamedEstimate
from lostmotion.models import Hammerstein
from lostmotion.models._arguments import FloatArray


@dataclass(frozen=True, eq=False)
class RecursiveEstimate(NamedEstimate):
    """What a recursive estimator knows after a sample; names as in ``HammersteinFit``."""

    status: Status
    model: Hammerstein
    parameters: dict[str, float]
    covariance: FloatArray
    samples: int


@dataclass(frozen=True, eq=False)
class Trajectory:
    """Estimates along a run.

    Attributes
    ----------
    samples : ndarray, shape (m,)
        Number of samples seen at each row.
    values : dict of ndarray
        left, right, left_slope, right_slope and the raw parameters theta (m, n).
    errors : ndarray, shape (n,)
        Prediction errors of every sample.
    """

    samples: npt.NDArray[np.int64]
    values: dict[str, FloatArray]
    errors: FloatArray

    def __getitem__(self, name: str) -> FloatArray:
        return self.values[name]
