from .actuator_text import actuator_summary
from .audit_text import audit_summary
from .design_text import achievable_summary, design_summary
from .diagnosis_text import diagnosis_summary
from .facts_text import facts_summary
from .fit_text import fit_summary
from .monte_carlo_text import monte_carlo_summary
from .pooled_text import pooled_summary
from .recursive_text import recursive_summary
from .remarks_on_fit import fit_remarks
from .solution_text import solution_summary
from .study_text import study_summary
from .table_of_diagnoses import diagnosis_line, diagnosis_table

__all__ = [
    "achievable_summary",
    "actuator_summary",
    "audit_summary",
    "design_summary",
    "diagnosis_line",
    "diagnosis_summary",
    "diagnosis_table",
    "facts_summary",
    "fit_remarks",
    "fit_summary",
    "monte_carlo_summary",
    "pooled_summary",
    "recursive_summary",
    "solution_summary",
    "study_summary",
]
