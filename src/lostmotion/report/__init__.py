"""Text and JSON of results."""

from lostmotion import _verbs
from lostmotion.evaluate import MonteCarloResult
from lostmotion.identify import HammersteinFit, RecursiveEstimate
from lostmotion.report.fit_text import fit_summary
from lostmotion.report.monte_carlo_text import monte_carlo_summary
from lostmotion.report.recursive_text import recursive_summary

_verbs.summary.register(HammersteinFit, fit_summary)
_verbs.summary.register(RecursiveEstimate, recursive_summary)
_verbs.summary.register(MonteCarloResult, monte_carlo_summary)

__all__ = ["fit_summary", "monte_carlo_summary", "recursive_summary"]
