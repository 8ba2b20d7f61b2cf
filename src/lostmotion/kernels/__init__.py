"""Numba functions on arrays and scalars only: pure, without objects or I/O.

Each has a slow, obvious twin in ``tests/naive``; ``NUMBA_DISABLE_JIT=1`` runs them as plain Python. What was compiled
from older sources is forgotten first (``compiled_before``, the only one that looks at files).
"""

from pathlib import Path as _Path

from lostmotion.kernels.compiled_before import forget_stale as _forget_stale

_forget_stale(_Path(__file__).parent)
