"""The commit that the working tree is at: what a page was measured with."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MEASURED = ("src", "benchmarks", "examples", "tests/plc", "constraints.txt")  # what a figure may depend on
CHANGED = "+"


def commit(root: Path = ROOT) -> str:
    """Twelve digits of it, with a plus where something that is measured was changed since; "unknown" without git."""
    try:
        at = _git(root, "rev-parse", "--short=12", "HEAD").strip()
        return at + (CHANGED if _git(root, "status", "--porcelain", "--", *MEASURED).strip() else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def _git(root: Path, *words: str) -> str:
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True, check=True)  # noqa: S607
    return done.stdout
