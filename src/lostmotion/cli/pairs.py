"""Options of two numbers, a low and a high one: ``--op-span 0 100``, and ``--op-span 0,100`` as well."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from typing import Any

METAVAR = "LOW HIGH"
_FLAG = re.compile(r"--(?:[a-z]+-)?(?:span|limits)")
_BOTH = re.compile(r"([^,=\s]+),\s*([^,=\s]+)")


def named(parameters: Iterable[Any]) -> None:
    """Let the help say that two numbers are wanted, a blank between them."""
    for one in parameters:
        if one.nargs == len(METAVAR.split()) and one.metavar is None:
            one.metavar = METAVAR


def apart(words: Sequence[str]) -> list[str]:
    """Words with the two numbers of such an option apart, however they were written.

    Examples
    --------
    >>> apart(["diagnose", "a.csv", "--op-span", "0,100", "--pv-span=-5,250", "--span", "0", "100"])
    ['diagnose', 'a.csv', '--op-span', '0', '100', '--pv-span', '-5', '250', '--span', '0', '100']
    >>> apart(["check", "a,b.csv"])
    ['check', 'a,b.csv']
    """
    found: list[str] = []
    for word in words:
        flag, equal, value = word.partition("=")
        behind = bool(found) and _FLAG.fullmatch(found[-1]) is not None
        if behind and (both := _BOTH.fullmatch(word)):
            found += both.groups()
        elif equal and _FLAG.fullmatch(flag) and (both := _BOTH.fullmatch(value)):
            found += [flag, *both.groups()]
        else:
            found.append(word)
    return found
