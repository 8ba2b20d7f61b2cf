"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.change import ChangeEvent
from lostmotion.identify.estimate import identify
from lostmotion.identify.many import run_many
from lostmotion.identify.recursive import RecursiveEstimate, Trajectory
from lostmotion.identify.recursive_iv import RecursiveIV
from lostmotion.identify.recursive_ml import RecursiveML
from lostmotion.identify.result import HammersteinFit

__all__ = [
    "ChangeEvent",
    "HammersteinFit",
    "RecursiveEstimate",
    "RecursiveIV",
    "RecursiveML",
    "Trajectory",
    "identify",
    "run_many",
]
