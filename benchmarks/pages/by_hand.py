"""Words by hand inside a page that a script writes: what its tables mean, judged on the run that they are from.

They live in the page itself, so that nobody has to run anything to mend them. When the page is made again they are
carried over, and say that they are older until somebody has read them beside the new tables and put the new commit into
their first line.
"""

from __future__ import annotations

import re

PLACE = "<!-- words by hand -->"  # in a template: where they go
NOTE = "*Written for an earlier run than that of the tables.*\n\n"
_WORDS = re.compile(r"<!-- by hand, for commit (\w+\+?) -->\n(.*?)<!-- end of the words by hand -->", flags=re.DOTALL)


def carried(new: str, old: str, commit: str) -> str:
    """A new page with the words of the old one; `commit` is that of the new page.

    Words that have lost their place in the template go to the end: nothing that somebody wrote is dropped in silence.
    """
    found = _WORDS.search(old)
    if PLACE not in new:
        if found is None:
            return new
        new = f"{new.rstrip()}\n\n{PLACE}\n"
    judged, words = found.groups() if found else ("unknown", "")
    note = "" if judged == commit else NOTE
    text = f"<!-- by hand, for commit {judged} -->\n{note}{words.replace(NOTE, '')}<!-- end of the words by hand -->"
    return new.replace(PLACE, text)


def judged_commit(text: str) -> str | None:
    """Commit that the words of a page were written for; None where it has none."""
    found = _WORDS.search(text)
    return None if found is None else found[1]
