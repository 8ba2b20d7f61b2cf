"""Figures, one file each; needs the extra ``lostmotion[plot]``."""

from lostmotion import _verbs
from lostmotion.audit.plant_view import PlantView
from lostmotion.design import TestDesign
from lostmotion.diagnose import Diagnosis, PooledDiagnosis
from lostmotion.evaluate import CompensationStudy
from lostmotion.identify import HammersteinFit
from lostmotion.plot.audit_figure import audit_figure
from lostmotion.plot.design_figure import design_figure
from lostmotion.plot.diagnosis_figure import diagnosis_figure
from lostmotion.plot.fit_figure import fit_figure
from lostmotion.plot.loop_figure import loop_figure
from lostmotion.plot.pooled_figure import pooled_figure
from lostmotion.plot.record_figure import record_figure
from lostmotion.plot.study_figure import study_figure
from lostmotion.records import LoopRecord
from lostmotion.simulate import LoopResponse

_verbs.plot.register(CompensationStudy, study_figure)
_verbs.plot.register(Diagnosis, diagnosis_figure)
_verbs.plot.register(HammersteinFit, fit_figure)
_verbs.plot.register(LoopRecord, record_figure)
_verbs.plot.register(LoopResponse, loop_figure)
_verbs.plot.register(PooledDiagnosis, pooled_figure)
_verbs.plot.register(PlantView, audit_figure)
_verbs.plot.register(TestDesign, design_figure)

__all__ = [
    "audit_figure",
    "design_figure",
    "diagnosis_figure",
    "fit_figure",
    "loop_figure",
    "pooled_figure",
    "record_figure",
    "study_figure",
]
