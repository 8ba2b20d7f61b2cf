"""Which loops a plant has, and where their data lie: loop list, and sources (files, tables, databases)."""

from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.loop_list import LoopList, loop_list_text, parse_loop_list, read_loop_list
from lostmotion.plant.open_plant import open_plant
from lostmotion.plant.propose import propose
from lostmotion.plant.source import PlantSource, Unread

__all__ = [
    "LoopList",
    "PlantLoop",
    "PlantSource",
    "Unread",
    "loop_list_text",
    "open_plant",
    "parse_loop_list",
    "propose",
    "read_loop_list",
]
