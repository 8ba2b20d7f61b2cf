"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.estimate import identify
from lostmotion.identify.facts import FitFacts, facts_of, read_fit
from lostmotion.identify.fit import HammersteinFit
from lostmotion.identify.rated_estimate import RatedEstimate
from lostmotion.identify.recursive.estimator import RecursiveEstimator, WatchingEstimator
from lostmotion.identify.recursive.iv import RecursiveIV
from lostmotion.identify.recursive.many import run_many
from lostmotion.identify.recursive.ml import RecursiveML
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent, RecursiveEstimate, Trajectory

__all__ = [
    "ChangeEvent",
    "FitFacts",
    "HammersteinFit",
    "RatedEstimate",
    "RecursiveEstimate",
    "RecursiveEstimator",
    "RecursiveIV",
    "RecursiveML",
    "Trajectory",
    "WatchingEstimator",
    "facts_of",
    "identify",
    "read_fit",
    "run_many",
]
