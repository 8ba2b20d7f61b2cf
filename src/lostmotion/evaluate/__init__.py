"""How good: bounds, indices, and estimators measured on random loops. What it offers stands in ``__init__.pyi``."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
