"""Commands that a command prints as hints, followed as a user would: none may be refused or lead back to itself."""

from __future__ import annotations

import re
import shlex
from dataclasses import dataclass, field

from tests.support.command import run

LINE = re.compile(r"^\s*(?:Next: |or: )?lostmotion (.+)$")
PLACES = {"KP": "1", "KI": "0.1", "REASON": "seen on the bench"}  # what a user has to put in
FIRST = ("check", "diagnose", "identify", "solve")
USAGE = 2


def hints(text):
    """Words behind `lostmotion` of every printed command that is complete."""
    found = [match[1] for match in map(LINE.match, text.splitlines()) if match]
    return [tuple(PLACES.get(word, word) for word in shlex.split(line)) for line in found]


@dataclass
class Walk:
    """Hints that were followed from one record.

    Attributes
    ----------
    codes : dict of int
        Exit code of each command that was run.
    circles, refused : list
        Ways that came back to a command of their own; commands that were wrong usage.
    """

    capsys: object
    depth: int = 3
    codes: dict = field(default_factory=dict)
    texts: dict = field(default_factory=dict)
    circles: list = field(default_factory=list)
    refused: list = field(default_factory=list)

    def follow(self, words, way=()):
        """Run a command and what it prints, down to the depth."""
        words = tuple(map(str, words))
        if words not in self.texts:
            self.codes[words], text, error = run(self.capsys, *words)
            self.texts[words] = text + error
            if self.codes[words] == USAGE:
                self.refused.append((*way, words, error))
        if len(way) == self.depth:
            return
        for hint in hints(self.texts[words]):
            if hint in (*way, words):
                self.circles.append((*way, words, hint))
            else:
                self.follow(hint, (*way, words))

    def all_from(self, file, *options, commands=FIRST):
        """Begin with each of the commands on a record."""
        for command in commands:
            self.follow((command, file, *options))
        return self

    def told(self, kinds):
        """Commands that were printed and know a dead zone only."""
        return [words for words in self.codes if words[0] in kinds]
