"""Work in other processes: isolated start, limits of time and memory, a death costs its task only."""

from lostmotion.workers.background import Background
from lostmotion.workers.isolated import ONE_THREAD, SAFE_PATH, empty_folder
from lostmotion.workers.pool import Died, Failed, Finished, Outcome, Pool, usable_processors
from lostmotion.workers.process import Process

__all__ = [
    "ONE_THREAD",
    "SAFE_PATH",
    "Background",
    "Died",
    "Failed",
    "Finished",
    "Outcome",
    "Pool",
    "Process",
    "empty_folder",
    "usable_processors",
]
