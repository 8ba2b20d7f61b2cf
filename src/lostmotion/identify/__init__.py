"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.estimate import identify
from lostmotion.identify.recursive_iv import RecursiveIV
from lostmotion.identify.result import HammersteinFit

__all__ = ["HammersteinFit", "RecursiveIV", "identify"]
