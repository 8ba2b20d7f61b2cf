"""Pages of the documentation: of which version they are, and make them again for a release.

``python -m benchmarks.pages`` makes all pages, oldest first. It can be stopped and started again at any time: a page is
written whole or not at all, and those that were made at this commit are left alone. Exit code
1: a page failed; the others are made.
"""

from __future__ import annotations

import argparse
import sys

from .ages import oldest_first
from .catalogue import BY_HAND
from .make import make
from .quoted import EXCERPTS, QUOTES
from .quotes import README, ROOT, differences, excerpt_differences, mend, shown


def main() -> int:
    """Parse, do, say."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.pages", description=__doc__)
    parser.add_argument("--list", action="store_true", help="show page, script, age and expected minutes; make nothing")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="these pages only")
    parser.add_argument("--most-minutes", type=float, default=float("inf"), help="begin no further page after these")
    parser.add_argument("--at-once", type=int, default=1, help="so many of the pages without times beside each other")
    parser.add_argument("--figures", action="store_true", help="show every quoted figure and the page it is from")
    parser.add_argument("--mend", action="store_true", help="put the figures of the pages into the texts")
    given = parser.parse_args()
    if given.list:
        print(table())
        return 0
    if given.figures or given.mend:
        print(*(mend(QUOTES) if given.mend else shown(QUOTES)), *excerpts(), sep="\n")
        return 0
    outcome = make(given.only, given.most_minutes, given.at_once)
    print(outcome)
    print(*differences(QUOTES), *excerpts(), sep="\n")
    return 1 if outcome.failed else 0


def excerpts() -> list[str]:
    """Lines of the README's shortened reports that their page does not have: to be put right by hand."""
    text = (ROOT / README).read_text(encoding="utf-8")
    return [f"by hand: {README}: {line}" for line in excerpt_differences(text, EXCERPTS)]


def table() -> str:
    """All pages, oldest first, then those written by hand."""
    lines = [f"{'page':28} {'made':10} {'version':8} {'state':19} {'minutes':>7}  script"]
    for one in oldest_first():
        made, version = (str(one.footer.made), one.footer.version) if one.footer else ("-", "-")
        needs = f" (needs {one.page.needs})" if one.page.needs else ""
        lines.append(
            f"{one.page.name:28} {made:10} {version:8} {one.state:19} {one.minutes:7g}  {one.page.script}{needs}"
        )
    return "\n".join([*lines, *(f"{name:28} by hand: {what}" for name, what in BY_HAND.items())])


if __name__ == "__main__":
    sys.exit(main())
