"""Work in other processes: isolated start, limits of time and memory, a death costs its task only."""

from lostmotion.workers.background import Background
from lostmotion.workers.isolated import ONE_THREAD, SAFE_PATH, empty_folder
from lostmotion.workers.pool import Outcome, Pool, WorkerDiedError, WorkerLateError, usable_processors
from lostmotion.workers.process import Process

__all__ = [
    "ONE_THREAD",
    "SAFE_PATH",
    "Background",
    "Outcome",
    "Pool",
    "Process",
    "WorkerDiedError",
    "WorkerLateError",
    "empty_folder",
    "usable_processors",
]
