"""Code for PLCs, from the same kernels that are simulated.

kernel (Python) -> :mod:`translate` -> typed tree -> :mod:`printer` in a dialect -> file; and back: ``restore`` of the
dialect -> :mod:`reader` -> :mod:`replay` against the kernel. A dialect is one module of :mod:`dialects`.
"""

from lostmotion.export.dialects import TARGETS, Dialect, register
from lostmotion.export.exported import Exported, export
from lostmotion.export.replay import Replay, replay

__all__ = ["TARGETS", "Dialect", "Exported", "Replay", "export", "register", "replay"]
