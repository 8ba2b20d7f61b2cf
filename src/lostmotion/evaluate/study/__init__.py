"""Evaluate before download: the identified loop without, with, and with mis-estimated compensation."""

from lostmotion.evaluate.study.controller import controller_of
from lostmotion.evaluate.study.result import CompensationStudy, LoopCase, MistakeCase
from lostmotion.evaluate.study.study import compensation_study

__all__ = ["CompensationStudy", "LoopCase", "MistakeCase", "compensation_study", "controller_of"]
