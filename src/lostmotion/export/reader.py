"""Executes exported ST in plain Python: a reader of its own for the subset, which knows nothing of the translator."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
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
LEVELS = (("OR",), ("XOR",), ("AND",), ("=", "<>"), ("<", ">", "<=", ">="), ("+", "-"), ("*", "/"))
PYTHON = {"OR": "or", "XOR": "!=", "AND": "and", "=": "==", "<>": "!="}
CALLS = {"MIN": "_min", "MAX": "_max", "ABS": "abs"}
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
        lines = ["def scan(v):", *self._body(1), "    return None"]
        space: dict[str, Any] = {"_real": self.real, "_min": _min, "_max": _max}
        exec(compile("\n".join(lines), "<exported block>", "exec"), space)  # noqa: S102  made of checked tokens only
        self._scan = space["scan"]
        self.values: dict[str, Any] = {}
        self.reset()

    def reset(self) -> None:
        """Start anew: every variable has its declared value."""
        self.values = {name: variable.value for name, variable in self.variables.items()}

    def run(
        self, settings: dict[str, float], columns: Sequence[str], rows: npt.ArrayLike, wanted: Sequence[str]
    ) -> FloatArray:
        """Outputs `wanted` (n, len(wanted)) of scans whose inputs `columns` are `rows` (n, len(columns))."""
        values = self.values
        for name, value in settings.items():
            values[name] = self._stored(name, value)
        rows = np.asarray(rows, dtype=np.float64)
        result = np.empty((len(rows), len(wanted)))
        with np.errstate(all="ignore"):
            for k, row in enumerate(rows):
                for name, value in zip(columns, row, strict=True):
                    values[name] = self._stored(name, value)
                self._scan(values)
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

    def _body(self, depth: int) -> list[str]:
        lines = []
        pad = "    " * depth
        while self._peek() not in ("END_FUNCTION_BLOCK", "ELSIF", "ELSE", "END_IF"):
            if self._peek() == "IF":
                lines += self._if(depth)
                continue
            name = self._variable(self._take())
            self._take(":=")
            value = self._expression(0)
            self._take(";")
            kind = {"BOOL": "bool", "DINT": "int"}.get(self.variables[name].type, "_real")
            lines.append(f"{pad}v[{name!r}] = {kind}({value})")
        return lines or [pad + "pass"]

    def _if(self, depth: int) -> list[str]:
        lines = []
        pad = "    " * depth
        while (word := self._take()) != "END_IF":
            if word == "ELSE":
                lines.append(f"{pad}else:")
            else:
                lines.append(f"{pad}{'if' if word == 'IF' else 'elif'} {self._expression(0)}:")
                self._take("THEN")
            lines += self._body(depth + 1)
        self._take(";")
        return lines

    def _variable(self, name: str) -> str:
        if name not in self.variables:
            raise DataError.expected("a declared variable", name, "the export is broken")
        return name

    def _expression(self, level: int) -> str:
        if level == len(LEVELS):
            return self._operand()
        text = self._expression(level + 1)
        while self._peek() in LEVELS[level]:
            sign = self._take()
            text = f"({text} {PYTHON.get(sign, sign)} {self._expression(level + 1)})"
        return text

    def _operand(self) -> str:
        word = self._take()
        if word in ("-", "NOT"):
            return f"({'-' if word == '-' else 'not '}{self._operand()})"
        if word == "(":
            text = self._expression(0)
            self._take(")")
            return f"({text})"
        if word[0].isdigit() or word.startswith(("REAL#", "LREAL#")):
            number = word.partition("#")[2] or word
            return f"_real({number})" if "." in number else number
        if word in ("TRUE", "FALSE"):
            return word.capitalize()
        return self._call(word) if self._peek() == "(" else f"v[{self._variable(word)!r}]"

    def _call(self, name: str) -> str:
        to_real = re.fullmatch(r"DINT_TO_L?REAL", name)
        function = CALLS.get(name) or ("_real" if to_real else "round" if re.fullmatch(r"L?REAL_TO_DINT", name) else "")
        if not function:
            raise DataError.expected("a known function", name, "the export is broken")
        self._take("(")
        arguments = [self._expression(0)]
        while self._peek() == ",":
            self._take()
            arguments.append(self._expression(0))
        self._take(")")
        return f"{function}({', '.join(arguments)})"


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
