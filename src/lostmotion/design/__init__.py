"""The test that is worth asking for: excitation by Fisher information, under the operator's limits."""

from lostmotion.design.achieve import Achievable, achievable
from lostmotion.design.designed import Prediction, TestDesign
from lostmotion.design.plan import design

__all__ = ["Achievable", "Prediction", "TestDesign", "achievable", "design"]
