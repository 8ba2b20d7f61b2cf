"""An error as a command tells it: a line on standard error, commands that lead on, and with --json an object."""

from __future__ import annotations

import json
from collections.abc import Sequence

from lostmotion.cli.closed_output import SHOWN, echo, say
from lostmotion.cli.commands_on import commands_on
from lostmotion.cli.progress import progress
from lostmotion.cli.wording import message
from lostmotion.errors import LostMotionError, one_line


def say_error(error: LostMotionError | ImportError, as_json: bool, words: Sequence[str] = ()) -> None:
    """Tell it; `words` were typed behind ``lostmotion``."""
    progress("")
    said, lines = one_line(message(error)), commands_on(error, words)
    if isinstance(error, LostMotionError) and as_json and not SHOWN.get():
        say(json.dumps({"error": type(error).__name__, "message": said} | ({"commands": lines} if lines else {})))
    echo("\n".join([f"error: {said}", *(f"    {line}" for line in lines)]), err=True)
