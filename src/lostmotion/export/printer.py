"""Trees as text: one printer, told by a syntax how operators, numbers, functions and statements are written.

Parentheses stand wherever the tools rank operators differently: around every comparison inside a condition, every
operand that is an operation on the right, and a minus sign.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from lostmotion.export.tree import (
    ARITHMETIC,
    COMPARISONS,
    LOGIC,
    Assign,
    Convert,
    Expression,
    If,
    Name,
    Number,
    Remark,
    Statement,
)

RANK = {"+": 1, "-": 1, "*": 2, "/": 2, "%": 2}
WORDS = {"%": "MOD"}


@dataclass(frozen=True)
class Syntax:
    """How a language writes what the tree holds.

    `operators` maps those that differ from ST; `calls` are patterns with {0}, {1}; `variable` is a pattern per section
    (e.g. ``#{}``); `numbers` is a pattern of constants inside arithmetic, e.g. ``REAL#{}``.
    """

    operators: Mapping[str, str] = field(default_factory=dict)
    calls: Mapping[str, str] = field(default_factory=dict)
    variable: Mapping[str, str] = field(default_factory=dict)
    numbers: str = "{}"
    number_suffix: str = ""
    true: str = "TRUE"
    false: str = "FALSE"
    negation: str = "NOT {}"
    assign: str = "{} := {};"
    if_: str = "IF {} THEN"
    elsif: str = "ELSIF {} THEN"
    else_: str = "ELSE"
    end_if: str = "END_IF;"
    remark: str = "(* {} *)"
    indent: str = "    "


@dataclass(frozen=True)
class Printer:
    """Text of statements in one dialect, with the names of variables."""

    syntax: Syntax
    names: Mapping[Name, str]

    def name(self, variable: Name) -> str:
        """Variable as the body writes it."""
        return self.syntax.variable.get(variable.section, "{}").format(self.names[variable])

    def number(self, number: Number, typed: bool = False) -> str:
        """Constant as the body writes it."""
        if number.kind == "bool":
            return self.syntax.true if number.value else self.syntax.false
        if number.kind == "int":
            return str(int(number.value))
        digits = f"{number.value:.1f}" if number.value == int(number.value) else repr(number.value).upper()
        text = digits + self.syntax.number_suffix
        return self.syntax.numbers.format(text) if typed and number.value >= 0 else text

    def expression(self, tree: Expression, typed: bool = False) -> str:
        """Text of an expression; `typed` inside arithmetic, where a bare constant could widen it."""
        if isinstance(tree, Name):
            return self.name(tree)
        if isinstance(tree, Number):
            return self.number(tree, typed)
        if isinstance(tree, Convert):
            return self.syntax.calls[f"to {tree.kind}"].format(self.expression(tree.operand))
        operator, operands = tree.operator, tree.operands
        if operator in ("min", "max", "abs"):
            calls = self.syntax.calls
            pattern = calls.get(f"{operator} {tree.kind}") or calls[operator]
            return pattern.format(*(self.expression(operand, True) for operand in operands))
        if operator == "neg":
            return "-" + self.operand(operands[0], True)
        if operator == "not":
            return self.syntax.negation.format(self.operand(operands[0]))
        word = self.syntax.operators.get(operator, WORDS.get(operator, operator.upper()))
        left, right = operands
        if operator in ARITHMETIC:
            return f"{self.left(left, operator)} {word} {self.operand(right, True)}"
        if operator in LOGIC and getattr(left, "operator", "") == operator:
            return f"{self.expression(left)} {word} {self.operand(right)}"
        if operator in COMPARISONS:
            return f"{self.side(left)} {word} {self.side(right)}"
        return f"{self.operand(left)} {word} {self.operand(right)}"

    def operand(self, tree: Expression, typed: bool = False) -> str:
        """Operand, in parentheses if it is an operation or has a sign."""
        text = self.expression(tree, typed)
        bare = isinstance(tree, Name | Convert) or (isinstance(tree, Number) and tree.value >= 0)
        return text if bare or getattr(tree, "operator", "") in ("min", "max", "abs") else f"({text})"

    def left(self, tree: Expression, operator: str) -> str:
        """Left operand of arithmetic: evaluated first anyway where it binds as tightly."""
        rank = RANK.get(getattr(tree, "operator", ""), 0)
        return self.expression(tree, True) if rank >= RANK[operator] else self.operand(tree, True)

    def side(self, tree: Expression) -> str:
        """Side of a comparison: arithmetic binds more tightly everywhere."""
        return self.expression(tree) if RANK.get(getattr(tree, "operator", "")) else self.operand(tree)

    def lines(self, statements: tuple[Statement, ...], depth: int = 0) -> list[str]:
        """Lines of the statements, indented."""
        result: list[str] = []
        pad = self.syntax.indent * depth
        for statement in statements:
            if isinstance(statement, Remark):
                result.append(pad + self.syntax.remark.format(statement.text))
            elif isinstance(statement, Assign):
                text = self.syntax.assign.format(self.name(statement.target), self.expression(statement.value))
                result.append(pad + text)
            else:
                result += self.branch(statement, pad, depth)
        return result

    def branch(self, statement: If, pad: str, depth: int) -> list[str]:
        """Lines of an IF."""
        result: list[str] = []
        for number, (condition, body) in enumerate(statement.branches):
            head = self.syntax.elsif if number else self.syntax.if_
            result.append(pad + head.format(self.expression(condition)))
            result += self.lines(body, depth + 1)
        if statement.otherwise:
            result.append(pad + self.syntax.else_)
            result += self.lines(statement.otherwise, depth + 1)
        result.append(pad + self.syntax.end_if)
        return result
