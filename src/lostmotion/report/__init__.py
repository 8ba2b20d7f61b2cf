"""Text and JSON of results."""

from lostmotion import _verbs
from lostmotion.identify import HammersteinFit, RecursiveEstimate
from lostmotion.report.fit_text import fit_summary
from lostmotion.report.recursive_text import recursive_summary

_verbs.summary.register(HammersteinFit, fit_summary)
_verbs.summary.register(RecursiveEstimate, recursive_summary)

__all__ = ["fit_summary", "recursive_summary"]
