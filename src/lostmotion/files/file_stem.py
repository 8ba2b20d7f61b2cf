"""Names of files after tags, which every system takes."""

from __future__ import annotations

import re
from urllib.parse import quote

# Names that Windows keeps for devices, with any ending: "Naming Files, Paths, and Namespaces", Win32 documentation
DEVICES = ("con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(1, 10)))
_DEVICE = re.compile(rf"(?:{'|'.join(DEVICES)}) *(?:\.|$)", re.IGNORECASE)


def file_stem(tag: str) -> str:
    """Name for a file of a loop, before its ending; signs that a name may not have are written as in an address.

    Examples
    --------
    >>> file_stem("FIC 101"), file_stem("FIC:101"), file_stem("Con")
    ('FIC 101', 'FIC%3A101', '%43on')
    """
    stem = quote(tag, safe=" ")
    return f"%{ord(stem[0]):02X}{stem[1:]}" if _DEVICE.match(stem) else stem
