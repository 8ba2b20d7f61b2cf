"""Commands that lead on after an error: what was typed, with the settings that the error names."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from lostmotion.addresses import without_password
from lostmotion.cli.wording import FLAGS, OFFERED, option_of
from lostmotion.printable import shell_line

MOST = 6  # commands under a message


def commands_on(error: Exception, words: Sequence[str], offered: Collection[str] | None = None) -> list[str]:
    """Command lines to paste, one for each setting that leads on and that the command has.

    Parameters
    ----------
    error : Exception
        With `ways`, where some are known.
    words : sequence of str
        What was typed behind ``lostmotion``; an option that is given anew takes the place of the old one.
    offered : collection of str, optional
        Options of the command; None: of the one that runs.

    Examples
    --------
    >>> from lostmotion.errors import TimeError
    >>> error = TimeError.expected("one time", "two", "..").leads_on({"dt": 30.0}, {"dt": 1.0, "time": False})
    >>> commands_on(error, ["check", "a b.csv"], ["--dt", "--ignore-time"])
    ["lostmotion check 'a b.csv' --dt 30", "lostmotion check 'a b.csv' --dt 1 --ignore-time"]
    """
    known = OFFERED.get() if offered is None else offered
    shown = ["lostmotion", *map(without_password, words)]
    lines = []
    for way in getattr(error, "ways", ())[:MOST]:
        options = [_option(name, value) for name, value in way.items()]
        if all(option[0] in known for option in options):
            values = {option[0]: len(option) - 1 for option in options}
            lines.append(shell_line([*_without(shown, values), *(word for option in options for word in option)]))
    return lines


def _without(words: Sequence[str], values: Mapping[str, int]) -> list[str]:
    """Words without options that are given anew, and as many values as each has."""
    kept: list[str] = []
    skipped = 0
    for word in words:
        name = word.split("=", maxsplit=1)[0]
        if skipped:
            skipped -= 1
        elif word in values:
            skipped = values[word]
        elif name not in values:
            kept.append(word)
    return kept


def _option(name: str, value: object) -> list[str]:
    option = option_of(name, str(value))
    if option in FLAGS.values():
        return [option]
    each = value if isinstance(value, tuple) else (value,)
    return [option, *(f"{one:.10g}" if isinstance(one, float) else str(one) for one in each)]
