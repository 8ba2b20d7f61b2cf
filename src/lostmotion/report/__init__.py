"""Text and JSON of results."""

from lostmotion import _verbs
from lostmotion.identify import HammersteinFit
from lostmotion.report.fit_text import fit_summary

_verbs.summary.register(HammersteinFit, fit_summary)

__all__ = ["fit_summary"]
