"""The ICINCO 2010 paper again: its tables and figures beside the published values."""

from lostmotion.paper.control import ControlStudy, study_control
from lostmotion.paper.estimation import EstimationStudy, study_estimation
from lostmotion.paper.page import to_dict, write_page

__all__ = ["ControlStudy", "EstimationStudy", "study_control", "study_estimation", "to_dict", "write_page"]
