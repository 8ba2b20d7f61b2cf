"""Numba functions on arrays and scalars only: pure, without objects or I/O.

Each has a slow, obvious twin in ``tests/naive``; ``NUMBA_DISABLE_JIT=1`` runs them as plain Python. What is compiled is
kept by ``numba_cache``, the only one that looks at files.
"""
