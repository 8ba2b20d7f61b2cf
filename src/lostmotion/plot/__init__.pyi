from .actuator_figure import actuator_figure
from .audit_figure import audit_figure
from .design_figure import design_figure
from .diagnosis_figure import diagnosis_figure
from .fit_figure import fit_figure
from .loop_figure import loop_figure
from .pooled_figure import pooled_figure
from .record_figure import record_figure
from .study_figure import study_figure

__all__ = [
    "actuator_figure",
    "audit_figure",
    "design_figure",
    "diagnosis_figure",
    "fit_figure",
    "loop_figure",
    "pooled_figure",
    "record_figure",
    "study_figure",
]
