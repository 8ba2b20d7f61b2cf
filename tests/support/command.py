"""A command in this process: its exit code, and what it has said."""

from __future__ import annotations

import pytest

from lostmotion.cli import main


def run(capsys, *words):
    """Exit code, standard output and standard error."""
    with pytest.raises(SystemExit) as stop:
        main([str(word) for word in words])
    seen = capsys.readouterr()
    return int(stop.value.code or 0), seen.out, seen.err
