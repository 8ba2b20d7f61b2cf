"""Typed tree of a block: what is left of a scan kernel when its Python is gone.

Kinds are "real", "bool" and "int". Every tree is pure: no calls, no loops, nothing that depends on the dialect.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeAlias

COMPARISONS = ("<", "<=", ">", ">=", "=", "<>")
ARITHMETIC = ("+", "-", "*", "/", "%")
LOGIC = ("and", "or")


@dataclass(frozen=True)
class Name:
    """A variable: section "parameter", "input", "state", "output" or "local"."""

    section: str
    name: str
    kind: str


@dataclass(frozen=True)
class Number:
    """A constant; kind "literal" until it meets a variable."""

    value: float
    kind: str = "literal"


@dataclass(frozen=True)
class Operation:
    """Operator or function on one or two operands; `kind` is the kind of the result."""

    operator: str  # + - * / % < <= > >= = <> and or not neg min max abs
    operands: tuple[Expression, ...]
    kind: str


@dataclass(frozen=True)
class Convert:
    """Whole number as a real, or a whole real as an int."""

    operand: Expression
    kind: str


Expression: TypeAlias = Name | Number | Operation | Convert


@dataclass(frozen=True)
class Assign:
    """target := value."""

    target: Name
    value: Expression


@dataclass(frozen=True)
class If:
    """IF .. ELSIF .. ELSE: (condition, statements) in turn, then the statements of ELSE."""

    branches: tuple[tuple[Expression, tuple[Statement, ...]], ...]
    otherwise: tuple[Statement, ...] = ()


@dataclass(frozen=True)
class Remark:
    """A comment: what the next part does."""

    text: str


Statement: TypeAlias = Assign | If | Remark


@dataclass(frozen=True)
class Block:
    """Body of a block and its local variables, in order of appearance."""

    body: tuple[Statement, ...]
    local_names: tuple[Name, ...] = field(default=())


def parts(expression: Expression) -> Iterator[Expression]:
    """The expression and all that it is made of."""
    yield expression
    if isinstance(expression, Operation):
        for operand in expression.operands:
            yield from parts(operand)
    elif isinstance(expression, Convert):
        yield from parts(expression.operand)


def every_statement(statements: tuple[Statement, ...]) -> Iterator[Statement]:
    """The statements and all inside them."""
    for statement in statements:
        yield statement
        if isinstance(statement, If):
            for _, body in statement.branches:
                yield from every_statement(body)
            yield from every_statement(statement.otherwise)


def each_statement(
    statements: tuple[Statement, ...], change: Callable[[Statement], list[Statement]]
) -> list[Statement]:
    """Statements with `change` applied to each, innermost first."""
    result: list[Statement] = []
    for statement in statements:
        if isinstance(statement, If):
            branches = tuple((condition, tuple(each_statement(body, change))) for condition, body in statement.branches)
            result += change(If(branches, tuple(each_statement(statement.otherwise, change))))
        else:
            result += change(statement)
    return result
