"""Every local variable and output has been assigned before it is read; every output is assigned in each scan.

Between scans a PLC keeps what a Python function forgets, so a value that is left over would make the two differ.
"""

from __future__ import annotations

from collections.abc import Sequence

from lostmotion.errors import ParameterError
from lostmotion.export.tree import Assign, Expression, If, Name, Statement, parts

FRESH = ("local", "output")


def check_assigned(body: tuple[Statement, ...], outputs: Sequence[Name]) -> None:
    """Raise ParameterError naming the variable that may be read, or left, without a value."""
    done = _walk(body, frozenset())
    for output in outputs:
        if (output.section, output.name) not in done:
            _refuse(output, "assigned on every path through the block")


def _walk(body: tuple[Statement, ...], done: frozenset[tuple[str, str]]) -> frozenset[tuple[str, str]]:
    for statement in body:
        if isinstance(statement, Assign):
            _reads(statement.value, done)
            done |= {(statement.target.section, statement.target.name)}
        elif isinstance(statement, If):
            ends = []
            for condition, inner in statement.branches:
                _reads(condition, done)
                ends.append(_walk(inner, done))
            ends.append(_walk(statement.otherwise, done))
            done = frozenset.intersection(*ends)
    return done


def _reads(expression: Expression, done: frozenset[tuple[str, str]]) -> None:
    for part in parts(expression):
        if isinstance(part, Name) and part.section in FRESH and (part.section, part.name) not in done:
            _refuse(part, "assigned on every path before it is read")


def _refuse(name: Name, expected: str) -> None:
    text = f"{name.section} {name.name} {expected}"
    raise ParameterError.expected(text, "a path without", "assign it at the beginning of the kernel")
