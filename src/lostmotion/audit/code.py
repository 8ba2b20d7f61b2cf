"""Version of the code that decides: what it has done with the same data need not be done again."""

from __future__ import annotations

import hashlib
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import lostmotion

APART = (  # rooms that no assessment depends on; one too many here would keep results of an older code
    "cli", "plot", "report", "paper", "export", "online", "design", "store", "web", "live",
)  # fmt: skip
NOT_OF_A_LOOP = (
    "engine",
    "run.py",
    "plan.py",
    "batches.py",
    "rank.py",
    "trend.py",
    "history.py",
    "groups.py",
)  # audit/
NUMERIC = ("numpy", "scipy", "numba", "polars")  # another one may give another last digit


@cache
def code_version() -> str:
    """Version of the package, with 12 hex digits of its sources and of the libraries that calculate."""
    root = Path(lostmotion.__file__).parent
    digest = hashlib.sha256(" ".join(_version(name) for name in NUMERIC).encode())
    for path in sorted(root.rglob("*")):
        parts = path.relative_to(root).parts
        if path.suffix not in (".py", ".npz") or parts[0] in APART:
            continue
        if parts[0] == "audit" and parts[1] in NOT_OF_A_LOOP:
            continue
        digest.update("/".join(parts).encode() + b"\0" + path.read_bytes())
    return f"{lostmotion.__version__}+{digest.hexdigest()[:12]}"


def _version(name: str) -> str:
    try:
        return f"{name}-{version(name)}"
    except PackageNotFoundError:
        return name
