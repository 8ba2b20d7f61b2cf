"""Which loops a plant has, and where their data lie: loop list, and sources (files, tables, databases)."""

from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.source import PlantSource, Unread

__all__ = ["PlantLoop", "PlantSource", "Unread"]
