"""Executes exported ST in plain Python: a reader of its own for the subset, which knows nothing of the translator.

Every statement and expression becomes a function of the values of the variables, made of the functions of its parts.
No text is run as Python: a name is a key of a dictionary, and a function one of those below.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError

TOKEN = re.compile(
    r"\s+|\(\*.*?\*\)|(?P<number>(?:L?REAL#)?\d+\.\d+(?:[Ee][+-]?\d+)?|\d+)|(?P<word>[A-Za-z]\w*)"
    r"|(?P<sign>:=|<>|<=|>=|[-+*/()<>=;:,])",
    re.S,
)
LEVELS = (("OR",), ("XOR",), ("AND",), ("=", "<>"), ("<", ">", "<=", ">="), ("+", "-"), ("*", "/", "MOD"))
Values = dict[str, Any]
Does = Callable[[Values], Any]  # what a piece of the program gives, or changes, for the values of all variables
REALS: dict[str, Any] = {"REAL": np.float32, "LREAL": np.float64}


@dataclass(frozen=True)
class Variable:
    """A declaration: section "VAR_INPUT", "VAR_OUTPUT" or "VAR", type, value before the first scan."""

    section: str
    type: str
    value: Any


class Program:
    """A FUNCTION_BLOCK that can be run scan by scan.

    Parameters
    ----------
    text : str
        ST of the exported subset.

    Raises
    ------
    DataError
        Something that is no such ST.
    """

    def __init__(self, text: str) -> None:
        self.tokens = _tokens(text)
        self.place = 0
        self.variables: dict[str, Variable] = {}
        self._declarations()
        real = {"REAL", "LREAL"} & {variable.type for variable in self.variables.values()}
        self.real = REALS[real.pop()] if len(real) == 1 else np.float64
        self._statements = self._body()
        self.values: Values = {}
        self.reset()

    def reset(self) -> None:
        """Start anew: every variable has its declared value."""
        self.values = {name: variable.value for name, variable in self.variables.items()}

    def run(
        self, settings: dict[str, float], columns: Sequence[str], rows: npt.ArrayLike, wanted: Sequence[str]
    ) -> FloatArray:
        """Outputs `wanted` (n, len(wanted)) of scans whose inputs `columns` are `rows` (n, len(columns))."""
        values, statements = self.values, self._statements
        for name, value in settings.items():
            values[name] = self._stored(name, value)
        rows = np.asarray(rows, dtype=np.float64)
        result = np.empty((len(rows), len(wanted)))
        with np.errstate(all="ignore"):
            for k, row in enumerate(rows):
                for name, value in zip(columns, row, strict=True):
                    values[name] = self._stored(name, value)
                for statement in statements:
                    statement(values)
                result[k] = [values[name] for name in wanted]
        return result

    def _stored(self, name: str, value: float) -> Any:
        kind = self.variables[name].type
        return bool(value) if kind == "BOOL" else int(value) if kind == "DINT" else self.real(value)

    def _peek(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def _take(self, expected: str = "") -> str:
        token = self._peek()
        if not token or (expected and token != expected):
            raise DataError.expected(f"ST with {expected or 'more'}", token or "its end", "the export is broken")
        self.place += 1
        return token

    def _declarations(self) -> None:
        self._take("FUNCTION_BLOCK")
        self._take()
        while self._peek().startswith("VAR"):
            section = self._take()
            while self._peek() != "END_VAR":
                self._declare(section)
            self._take()

    def _declare(self, section: str) -> None:
        name = self._take()
        self._take(":")
        kind, text = self._take(), "0"
        if self._peek() == ":=":
            self._take()
            text = "-" + self._take() if self._peek() == "-" and self._take() else self._take()
        self._take(";")
        if name in self.variables:
            raise DataError.expected("every variable once", name, "the export is broken")
        value: Any = text == "TRUE" if kind == "BOOL" else int(text) if kind == "DINT" else REALS[kind](text)
        self.variables[name] = Variable(section, kind, value)

    def _body(self) -> tuple[Does, ...]:
        statements = []
        while self._peek() not in ("END_FUNCTION_BLOCK", "ELSIF", "ELSE", "END_IF"):
            statements.append(self._if() if self._peek() == "IF" else self._assignment())
        return tuple(statements)

    def _assignment(self) -> Does:
        name = self._variable(self._take())
        self._take(":=")
        value = self._expression(0)
        self._take(";")
        kind: Callable[[Any], Any] = {"BOOL": bool, "DINT": int}.get(self.variables[name].type, self.real)

        def assign(v: Values) -> None:
            v[name] = kind(value(v))

        return assign

    def _if(self) -> Does:
        branches: list[tuple[Does, tuple[Does, ...]]] = []
        otherwise: tuple[Does, ...] = ()
        while (word := self._take()) != "END_IF":
            if word == "ELSE":
                otherwise = self._body()
                continue
            condition = self._expression(0)
            self._take("THEN")
            branches.append((condition, self._body()))
        self._take(";")

        def choose(v: Values) -> None:
            chosen = otherwise
            for condition, body in branches:
                if condition(v):
                    chosen = body
                    break
            for statement in chosen:
                statement(v)

        return choose

    def _variable(self, name: str) -> str:
        if name not in self.variables:
            raise DataError.expected("a declared variable", name, "the export is broken")
        return name

    def _expression(self, level: int) -> Does:
        if level == len(LEVELS):
            return self._operand()
        left = self._expression(level + 1)
        while self._peek() in LEVELS[level]:
            sign = self._take()
            left = BINARY[sign](left, self._expression(level + 1))
        return left

    def _operand(self) -> Does:
        word = self._take()
        if word in ("-", "NOT"):
            inner = self._operand()
            return (lambda v: -inner(v)) if word == "-" else (lambda v: not inner(v))
        if word == "(":
            inner = self._expression(0)
            self._take(")")
            return inner
        if word[0].isdigit() or word.startswith(("REAL#", "LREAL#")):
            number = word.partition("#")[2] or word
            return _constant(self.real(float(number)) if "." in number else int(number))
        if word in ("TRUE", "FALSE"):
            return _constant(word == "TRUE")
        return self._call(word) if self._peek() == "(" else itemgetter(self._variable(word))

    def _call(self, name: str) -> Does:
        to_real = re.fullmatch(r"DINT_TO_L?REAL", name)
        known: Callable[..., Any] | None = (
            self.real if to_real else round if re.fullmatch(r"L?REAL_TO_DINT", name) else CALLS.get(name)
        )
        if known is None:
            raise DataError.expected("a known function", name, "the export is broken")
        function = known
        self._take("(")
        given = [self._expression(0)]
        while self._peek() == ",":
            self._take()
            given.append(self._expression(0))
        self._take(")")
        if len(given) != (2 if name in ("MIN", "MAX") else 1):
            raise DataError.expected(f"{name} of its arguments", str(len(given)), "the export is broken")
        first, last = given[0], given[-1]
        return (lambda v: function(first(v), last(v))) if len(given) == 2 else (lambda v: function(first(v)))


def _tokens(text: str) -> list[str]:
    result, place = [], 0
    while place < len(text):
        found = TOKEN.match(text, place)
        if not found:
            raise DataError.expected("ST of the exported subset", text[place : place + 20], "the export is broken")
        if found.lastgroup:
            result.append(found.group())
        place = found.end()
    return result


def _min(a: Any, b: Any) -> Any:
    return b if b < a else a


def _max(a: Any, b: Any) -> Any:
    return b if b > a else a


def _constant(value: Any) -> Does:
    return lambda _: value


CALLS: dict[str, Callable[..., Any]] = {"MIN": _min, "MAX": _max, "ABS": abs}
BINARY: dict[str, Callable[[Does, Does], Does]] = {
    "OR": lambda a, b: lambda v: a(v) or b(v),
    "XOR": lambda a, b: lambda v: a(v) != b(v),
    "AND": lambda a, b: lambda v: a(v) and b(v),
    "=": lambda a, b: lambda v: a(v) == b(v),
    "<>": lambda a, b: lambda v: a(v) != b(v),
    "<": lambda a, b: lambda v: a(v) < b(v),
    ">": lambda a, b: lambda v: a(v) > b(v),
    "<=": lambda a, b: lambda v: a(v) <= b(v),
    ">=": lambda a, b: lambda v: a(v) >= b(v),
    "+": lambda a, b: lambda v: a(v) + b(v),
    "-": lambda a, b: lambda v: a(v) - b(v),
    "*": lambda a, b: lambda v: a(v) * b(v),
    "/": lambda a, b: lambda v: a(v) / b(v),
    "MOD": lambda a, b: lambda v: int(math.fmod(a(v), b(v))),
}
