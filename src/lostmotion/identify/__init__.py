"""Identification: record -> Hammerstein model with uncertainty."""

from lostmotion.identify.estimate import identify
from lostmotion.identify.result import HammersteinFit

__all__ = ["HammersteinFit", "identify"]
