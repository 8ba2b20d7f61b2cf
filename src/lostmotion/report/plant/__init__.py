"""Reports of an audit: a plant or a loop as one HTML file, the table as a data frame.

What makes one of a diagnosis (:mod:`lostmotion.report.plant.of_diagnosis`) needs all of the diagnosis, and is not
loaded with them: a page that shows a store would start seconds later.
"""

from lostmotion.audit.plant_view import LoopView, PlantView, RunFacts, SizePoint
from lostmotion.report.plant.loop_page import LoopPage, loop_page
from lostmotion.report.plant.pages import loop_report, loop_section, plant_context, plant_report, script, stylesheet
from lostmotion.report.plant.table import table

__all__ = [
    "LoopPage",
    "LoopView",
    "PlantView",
    "RunFacts",
    "SizePoint",
    "loop_page",
    "loop_report",
    "loop_section",
    "plant_context",
    "plant_report",
    "script",
    "stylesheet",
    "table",
]
