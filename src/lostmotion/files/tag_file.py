"""Name of the file of a tag: another one for each tag, on every system, and never a path."""

from __future__ import annotations

import hashlib
import re
from urllib.parse import quote

LONGEST = 100  # characters that are kept of a tag: 255 bytes are a name, and the writer puts some before it
# names that Windows keeps for devices, whatever ending they have ("Naming Files, Paths, and Namespaces")
DEVICES = (
    *("con", "prn", "aux", "nul", "conin$", "conout$"),
    *(f"{port}{number}" for port in ("com", "lpt") for number in range(10)),
)
DEVICE = re.compile(rf"(?:{'|'.join(map(re.escape, DEVICES))}) *(?:\..*)?", re.IGNORECASE)


def tag_file(tag: str, ending: str) -> str:
    """File name of a tag.

    Tags of capitals, digits and plain signs stand as they are. Windows and macOS take "a" for "A", so that a tag with
    small letters, and one that is long or that a system would take for something else, has a digest behind it. "%-"
    comes from no tag: after "%" there are two digits.

    Examples
    --------
    >>> tag_file("FIC-101", ".state"), tag_file("A/B 2", ".state"), tag_file("fic-101", ".state")
    ('FIC-101.state', 'A%2FB 2.state', 'fic-101%-530e7320c8b2cbbb.state')
    """
    name = quote(tag, safe=" ", errors="surrogatepass")
    device = DEVICE.fullmatch(name) is not None
    plain = name == name.upper() and name == name.strip(" .") and 0 < len(name) <= LONGEST
    if plain and not device:
        return name + ending
    digest = hashlib.sha256(tag.encode("utf-8", "surrogatepass")).hexdigest()[:16]
    return f"{'%' if device else ''}{name[:LONGEST].strip(' .')}%-{digest}{ending}"
