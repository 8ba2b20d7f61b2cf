"""Many loops: screen, assess, rank, group, follow; on this machine or on a cluster.

Names are loaded when they are used: workers need no database.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
