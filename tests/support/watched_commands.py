"""What every command that writes does, as JSON: `python -m tests.support.watched_commands FOLDER OUT`.

In a process of its own: commands are forked from it, which hangs in one that has threads of Polars.
"""

import json
import sys
from pathlib import Path

from lostmotion.cli import main
from tests.support import commands_that_write as commands
from tests.support.watched import doings


def watched(folder):
    """Events of each command by its name; `folder` is where what they read is made."""
    given = commands.prepare(folder)
    commands.warm()
    audit = ["audit", str(Path(given.record).parent), "--engine", "inline", "--screen-only"]
    all_words = {
        **commands.writing(given),
        "audit": lambda at: [*audit, "--store", f"{at}/p.db", "--report", f"{at}/p.html"],
    }
    found = {}
    for number, (name, words) in enumerate(all_words.items()):
        place = folder.parent / f"at-{number}"
        place.mkdir()
        code, found[name] = doings(lambda words=words, place=place: main(words(place)), place)
        assert code in (0, 1), name
    return found


if __name__ == "__main__":
    given, out = Path(sys.argv[1]) / "given", Path(sys.argv[2])
    given.mkdir()
    out.write_text(json.dumps(watched(given)), encoding="utf-8")
