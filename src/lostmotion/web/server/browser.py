"""The page opened in the browser of whoever started it."""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import webbrowser
from html import escape
from pathlib import Path

GONE = 30.0  # s after which no browser will still come for the file


def open_in_browser(address: str) -> None:
    """Open it, where there is a screen.

    The address holds the token, and what stands in a command line every user of the machine can read: the browser is
    given a file that only this user can read, which leads to it.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return
    file, name = tempfile.mkstemp(suffix=".html", prefix="lostmotion-")
    text = f'<!doctype html><meta http-equiv="refresh" content="0; url={escape(address)}"><title>lostmotion</title>'
    with os.fdopen(file, "w", encoding="utf-8") as writer:
        writer.write(text)
    path = Path(name)
    ending = threading.Timer(GONE, path.unlink, kwargs={"missing_ok": True})
    ending.daemon = True
    ending.start()
    threading.Thread(target=webbrowser.open, args=(path.as_uri(),), daemon=True).start()
