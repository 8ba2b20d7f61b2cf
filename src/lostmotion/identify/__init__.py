"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.estimate import identify
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.recursive.estimate import ChangeEvent, RecursiveEstimate, Trajectory
from lostmotion.identify.recursive.estimator import RecursiveEstimator, WatchingEstimator
from lostmotion.identify.recursive.iv import RecursiveIV
from lostmotion.identify.recursive.many import run_many
from lostmotion.identify.recursive.ml import RecursiveML

__all__ = [
    "ChangeEvent",
    "HammersteinFit",
    "RecursiveEstimate",
    "RecursiveEstimator",
    "RecursiveIV",
    "RecursiveML",
    "Trajectory",
    "WatchingEstimator",
    "identify",
    "run_many",
]
