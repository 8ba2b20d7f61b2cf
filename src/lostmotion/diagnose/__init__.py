"""What is wrong with a loop: known indices, each of one signal or of OP and PV together.

Names are loaded when they are used: the screen of an audit needs a few of them, and no fit.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
