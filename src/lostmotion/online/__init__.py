"""Estimation beside the plant: rows come in, reports and events go out, and everything can be stopped and gone on.

Names are loaded when they are used: who only looks at what a monitor has written needs no estimator.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
