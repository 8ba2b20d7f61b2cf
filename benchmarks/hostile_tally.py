"""Tallies of attacks that tell what has been tried when they are ended before their end."""

from __future__ import annotations

import signal
import sys
import time
from collections import Counter
from collections.abc import Iterable

from hostile_log import OTHERS, Log

NOWHERE = Log()
HEAD = "| attack | outcome | times |\n|---|---|---|"
EVERY = 20.0  # s between looks at what has been tried so far


def told(name: str, tries: Iterable[Counter[str]], log: Log = NOWHERE) -> bool:
    """Print a row for each outcome; True where one is in capitals. SIGTERM and Ctrl-C end the attack, not the table."""
    tally: Counter[str] = Counter()
    kept_before: Counter[str] = Counter()
    begun = shown = time.monotonic()
    kept = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        for one in tries:
            tally.update(one)
            if time.monotonic() - shown > EVERY:
                log.add(OTHERS, name, tally - kept_before, time.monotonic() - shown)
                shown, kept_before = time.monotonic(), Counter(tally)
                print(f"{name} so far: {dict(tally)}", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        tally["stopped before its end"] = 1
    finally:
        signal.signal(signal.SIGTERM, kept)
    log.add(OTHERS, name, tally - kept_before, time.monotonic() - shown)
    for said, times in sorted((+tally).items()):
        print(f"| {name} | {said} | {times} |", flush=True)
    print(f"{name}: {time.monotonic() - begun:.0f} s", file=sys.stderr)
    return any(said[:3].isupper() for said in +tally)
