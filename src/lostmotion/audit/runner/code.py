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
NOT_OF_A_LOOP = (  # of audit/: what puts results into order, tells them or hands out the work
    "audit_run.py", "groups", "health.py", "history.py", "labels.py", "measurement.py", "plant_audit.py",
    "plant_view.py", "rank.py", "row_facts.py", "rules.py", "run_view.py", "runner/batches.py", "runner/code.py",
    "runner/engine", "runner/plan.py", "runner/run.py",
)  # fmt: skip
AWAY = tuple(f"{name}/" for name in APART) + tuple(f"audit/{name}" for name in NOT_OF_A_LOOP)
NUMERIC = ("numpy", "scipy", "numba", "polars")  # another one may give another last digit


@cache
def code_version() -> str:
    """Version of the package, with 12 hex digits of its sources and of the libraries that calculate."""
    root = Path(lostmotion.__file__).parent
    digest = hashlib.sha256(" ".join(_version(name) for name in NUMERIC).encode())
    for path in sorted(root.rglob("*")):
        name = path.relative_to(root).as_posix()
        if path.suffix in (".py", ".npz") and not name.startswith(AWAY):
            digest.update(name.encode() + b"\0" + path.read_bytes())
    return f"{lostmotion.__version__}+{digest.hexdigest()[:12]}"


def _version(name: str) -> str:
    try:
        return f"{name}-{version(name)}"
    except PackageNotFoundError:
        return name
