"""Batches of loops done side by side: processes of this machine, or Dask; the same results from each."""

from lostmotion.audit.runner.engine.choice import open_engine
from lostmotion.audit.runner.engine.protocol import Done, Engine, Lost, Task
from lostmotion.errors import EngineError

__all__ = ["Done", "Engine", "EngineError", "Lost", "Task", "open_engine"]
