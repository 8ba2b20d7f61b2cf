"""Made plants: loops that disturb each other, with faults, operators and a historian, and the truth about all of it."""

from lostmotion.evaluate.plants.made_loop import MadeLoop
from lostmotion.evaluate.plants.plant import MadePlant, random_plant
from lostmotion.evaluate.plants.truth import CAUSES, FAULTS, LoopTruth

__all__ = ["CAUSES", "FAULTS", "LoopTruth", "MadeLoop", "MadePlant", "random_plant"]
