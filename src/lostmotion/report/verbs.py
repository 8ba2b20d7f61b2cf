"""The verbs of results that make text and HTML: loaded when the first of them is used, and all results with them."""

from lostmotion import _verbs
from lostmotion.audit.plant_view import PlantView
from lostmotion.compensate import CompensatorBlock
from lostmotion.design import Achievable, TestDesign
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.evaluate import CompensationStudy, MonteCarloResult, Solution
from lostmotion.identify import FitFacts, HammersteinFit, RecursiveEstimate
from lostmotion.report.audit_text import audit_summary
from lostmotion.report.design_text import achievable_summary, design_summary
from lostmotion.report.diagnosis_text import diagnosis_summary
from lostmotion.report.facts_text import facts_summary
from lostmotion.report.fit_text import fit_summary
from lostmotion.report.monte_carlo_text import monte_carlo_summary
from lostmotion.report.notebook import (
    audit_frame,
    audit_html,
    block_html,
    diagnosis_html,
    facts_html,
    fit_html,
    pooled_html,
    recursive_html,
    solution_html,
    study_html,
)
from lostmotion.report.pooled_text import pooled_summary
from lostmotion.report.recursive_text import recursive_summary
from lostmotion.report.remarks_on_fit import fit_remarks
from lostmotion.report.solution_text import solution_summary
from lostmotion.report.study_text import study_summary

_verbs.frame.register(PlantView, audit_frame)
_verbs.html.register(PlantView, audit_html)
_verbs.summary.register(PlantView, audit_summary)
_verbs.summary.register(CompensationStudy, study_summary)
_verbs.summary.register(Solution, solution_summary)
_verbs.summary.register(Achievable, achievable_summary)
_verbs.summary.register(TestDesign, design_summary)
_verbs.summary.register(HammersteinFit, fit_summary)
_verbs.summary.register(FitFacts, facts_summary)
_verbs.remarks.register(HammersteinFit, fit_remarks)
_verbs.summary.register(Diagnosis, diagnosis_summary)
_verbs.summary.register(PooledDiagnosis, pooled_summary)
_verbs.summary.register(RecursiveEstimate, recursive_summary)
_verbs.summary.register(MonteCarloResult, monte_carlo_summary)
_verbs.html.register(CompensationStudy, study_html)
_verbs.html.register(CompensatorBlock, block_html)
_verbs.html.register(Diagnosis, diagnosis_html)
_verbs.html.register(FitFacts, facts_html)
_verbs.html.register(HammersteinFit, fit_html)
_verbs.html.register(PooledDiagnosis, pooled_html)
_verbs.html.register(RecursiveEstimate, recursive_html)
_verbs.html.register(Solution, solution_html)
