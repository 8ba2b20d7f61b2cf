"""Files and data frames -> LoopRecord: the only place that knows formats.

Names are loaded when they are used: who writes a result needs no readers.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
