"""Pages that know their age: each is written by a script and says from which source.

``python -m benchmarks.pages --list`` shows all of them, ``make pages`` makes the stale ones again, oldest first.
"""

from .kept import kept
from .publish import publish

__all__ = ["kept", "publish"]
