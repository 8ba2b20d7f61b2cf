"""What attacks have tried, in a file of JSON lines: a run that is ended goes on where it was, a page is made of it.

A line is ``{"attack", "part", "source", "tally": {outcome: times}, "seconds", ..}`` and says what came since the line
before it. `source` is a digest of what was attacked: what was tried on another source is told apart.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import lostmotion as lm

SHOWN = 12  # hexadecimal digits of a digest


COMMON = ("files", "records", "arrays.py", "arguments.py", "errors.py")
PARTS = {  # of the package that are attacked
    "readers": COMMON,
    "files beside records": (*COMMON, "compensate", "identify", "live", "online", "plant", "store", "web"),
}
OTHERS = "others"  # than readers: what lostmotion writes, and reads of its own
BESIDE_THEM = ("audit", "live", "plant", "store", "web")  # reached by none of those


@cache
def source(attack: str = "") -> str:
    """Digest of the part of the package that an attack is on, or of all of it; asked before the first attack."""
    package = Path(lm.__file__).parent
    found = [path for part in PARTS.get(attack, (".",)) for path in _files(package / part)]
    if attack == OTHERS:
        found = [path for path in found if path.relative_to(package).parts[0] not in BESIDE_THEM]
    whole = sha256()
    for path in sorted(found):
        whole.update(f"{path.relative_to(package).as_posix()}\0".encode() + path.read_bytes())
    return whole.hexdigest()[:SHOWN]


def _files(path: Path) -> list[Path]:
    return [path] if path.suffix else list(path.rglob("*.py"))


@dataclass(frozen=True)
class Entry:
    """One line: what was tried of a part of an attack, and what came of it."""

    attack: str
    part: str
    tally: Counter[str]
    seconds: float
    source: str
    more: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Log:
    """The file; without a path nothing is kept."""

    path: Path | None = None

    def add(self, attack: str, part: str, tally: Counter[str], seconds: float, **more: Any) -> None:
        """Keep what was tried since the last time."""
        if self.path is None:
            return
        known = {"attack": attack, "part": part, "source": source(attack), "tally": dict(tally), "seconds": seconds}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as stream:
            stream.write(json.dumps({**known, **more}) + "\n")

    def entries(self) -> Iterator[Entry]:
        """All that was kept, in order; a line that a kill has cut is passed over."""
        if self.path is None or not self.path.exists():
            return
        for line in self.path.read_text(encoding="utf-8").splitlines():
            try:
                told = json.loads(line)
            except ValueError:
                continue
            known = [told.pop(name) for name in ("attack", "part", "tally", "seconds", "source")]
            yield Entry(known[0], known[1], Counter(known[2]), *known[3:], more=told)
