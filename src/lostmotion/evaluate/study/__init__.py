"""Evaluate before download: the identified loop without, with, and with mis-estimated compensation."""

from lostmotion.evaluate.study.recorded_controller import controller_of
from lostmotion.evaluate.study.study import compensation_study
from lostmotion.evaluate.study.study_result import CompensationStudy, LoopCase, MistakeCase

__all__ = ["CompensationStudy", "LoopCase", "MistakeCase", "compensation_study", "controller_of"]
