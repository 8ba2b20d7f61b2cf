"""Reports of an audit: a plant or a loop as one HTML file, the table as a data frame."""

from lostmotion.audit.plant_view import LoopView, PlantView, RunFacts, SizePoint
from lostmotion.report.plant.loop_page import LoopPage, loop_page
from lostmotion.report.plant.of_diagnosis import diagnosis_report, diagnosis_view
from lostmotion.report.plant.pages import loop_report, loop_section, plant_context, plant_report, script, stylesheet
from lostmotion.report.plant.table import table

__all__ = [
    "LoopPage",
    "LoopView",
    "PlantView",
    "RunFacts",
    "SizePoint",
    "diagnosis_report",
    "diagnosis_view",
    "loop_page",
    "loop_report",
    "loop_section",
    "plant_context",
    "plant_report",
    "script",
    "stylesheet",
    "table",
]
