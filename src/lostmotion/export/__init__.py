"""Code for PLCs, from the same kernels that are simulated.

kernel (Python) -> :mod:`translate` -> typed tree -> :mod:`printer` in a dialect -> file; and back: :mod:`restore` ->
:mod:`reader` -> :mod:`replay` against the kernel.
"""

from lostmotion.export.exported import TARGETS, Exported, export
from lostmotion.export.replay import Replay, replay

__all__ = ["TARGETS", "Exported", "Replay", "export", "replay"]
