"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.estimate import identify
from lostmotion.identify.many import run_many
from lostmotion.identify.recursive_iv import RecursiveIV
from lostmotion.identify.result import HammersteinFit

__all__ = ["HammersteinFit", "RecursiveIV", "identify", "run_many"]
