"""What NumPy raises on bytes that are no archive, or a damaged one."""

from __future__ import annotations

import zipfile
import zlib

BROKEN = (ValueError, OSError, KeyError, EOFError, TypeError, IndexError, zipfile.BadZipFile, zlib.error)
