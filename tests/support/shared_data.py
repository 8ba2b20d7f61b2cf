"""Where the real records lie: a folder beside the repository, never inside it."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.support.places import SHARED

ROOT = SHARED / "data"


def shared(path: str) -> Path:
    """Path of a shared file or folder; where it is absent, skip, or fail if the environment has CI set."""
    return beside(f"data/{path}")


def beside(path: str) -> Path:
    """Path in the folder of all that is shared; the same where it is absent."""
    found = SHARED / path
    if not found.exists():
        reason = f"shared/{path} is not beside the repository"
        if os.environ.get("CI"):
            pytest.fail(reason)
        pytest.skip(reason)
    return found


def shared_files(pattern: str) -> list[Path]:
    """Files that fit a pattern, for parametrised tests; where there are none, a path that leads to a skip."""
    return sorted(ROOT.glob(pattern)) or [ROOT / pattern.replace("*", "absent")]
