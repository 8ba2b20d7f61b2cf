"""From the Python text of a scan kernel to the typed tree, refusing whatever a PLC would not do alike.

The subset: assignments to ``s[NAME]``, ``o[NAME]`` and local scalars, if / elif / else, calls of functions of the same
form (inlined); + - * / unary minus, comparisons of two operands, and / or / not in conditions, min, max, abs, % of
whole numbers that are not negative; float constants of the module, where REAL holds them exactly.

A kernel in front of another hands it ``q = p.copy()`` with ``q[NAME] = s[OTHER]``: the PLC copies nothing, the inner
kernel reads OTHER where it says NAME.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.export import types as kinds
from lostmotion.export.assigned import check_assigned
from lostmotion.export.tree import (
    Assign,
    Block,
    Expression,
    If,
    Name,
    Number,
    Operation,
    Remark,
    Statement,
    every_statement,
)

ARRAYS = {"p": "parameter", "s": "state", "i": "input", "o": "output"}
COPIED = ("p", "i")
WRITABLE = ("state", "output")
ARITHMETIC = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/", ast.Mod: "%"}
COMPARISON = {ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "=", ast.NotEq: "<>"}
LARGEST_LITERAL = 2.0**24  # every whole number up to here is exact in REAL


def translate(step: Any, variables: Sequence[Any]) -> Block:
    """Typed tree of the scan kernel `step`.

    Parameters
    ----------
    step : function
        ``step(p, s, i, o)``, plain or compiled by Numba.
    variables : sequence
        The variable table: each has `name`, `section` and `kind`; within a section in the order of the indices.

    Raises
    ------
    ParameterError
        Something outside the subset, with function and line.
    """
    table = _Table(variables)
    for _ in range(8):  # kinds of local variables settle after as many rounds as they feed each other
        before = dict(table.local_kinds)
        _Function(step, table, ()).statements()
        if table.local_kinds == before:
            break
    table.local_kinds = {key: "real" if kind == "literal" else kind for key, kind in table.local_kinds.items()}
    body = _Function(step, table, ()).statements()
    local_names = tuple(Name("local", name, kind) for name, kind in table.local_kinds.items())
    check_assigned(body, [Name("output", v.name, v.kind) for v in variables if v.section == "output"])
    return Block(body, local_names)


class _Table:
    """What is known of variables: the table of the specification, and local ones as they are met."""

    def __init__(self, variables: Sequence[Any]) -> None:
        self.sections: dict[str, list[Any]] = {section: [] for section in ARRAYS.values()}
        for variable in variables:
            self.sections[variable.section].append(variable)
        self.local_kinds: dict[str, str] = {}
        self.owners: dict[str, str] = {}

    def local(self, name: str, function: str) -> str:
        """Name of a local variable in the whole block; functions do not share theirs."""
        owner = self.owners.setdefault(name, function)
        return name if owner == function else f"{name}_{function}"


@dataclass(frozen=True)
class _Array:
    """What an argument of a kernel stands for: a section, and what is read instead of some of its variables."""

    section: str
    instead: dict[str, Name] = field(default_factory=dict)


PLAIN = {letter: _Array(section) for letter, section in ARRAYS.items()}


class _Function:
    """One function of the kernel on its way into the tree."""

    def __init__(
        self, function: Any, table: _Table, callers: tuple[str, ...], given: Mapping[str, _Array] = PLAIN
    ) -> None:
        plain = getattr(function, "py_func", function)
        self.table = table
        self.known = plain.__globals__
        self.name = plain.__name__
        self.callers = (*callers, self.name)
        self.given = given
        self.copies: dict[str, _Array] = {}
        lines, self.first_line = inspect.getsourcelines(plain)
        node = ast.parse(textwrap.dedent("".join(lines))).body[0]
        if not isinstance(node, ast.FunctionDef) or [a.arg for a in node.args.args] != list(ARRAYS):
            self.refuse(node, "a function of (p, s, i, o)")
        assert isinstance(node, ast.FunctionDef)  # noqa: S101
        self.node = node

    def refuse(self, node: ast.AST, expected: str) -> None:
        """Raise with the place of `node`."""
        line = self.first_line + getattr(node, "lineno", 1) - 1
        got = ast.unparse(node).splitlines()[0]
        raise ParameterError.expected(expected, f"`{got}` ({self.name}, line {line})", "keep to the subset of kernels")

    def statements(self) -> tuple[Statement, ...]:
        """Body of the function, after a remark with the first line of its docstring."""
        text = ast.get_docstring(self.node)
        body = self.node.body[1:] if text else self.node.body
        remark = [Remark(text.splitlines()[0])] if text else []
        return (*remark, *self.body(body))

    def body(self, nodes: list[ast.stmt]) -> tuple[Statement, ...]:
        result: list[Statement] = []
        for node in nodes:
            result += self.statement(node)
        return tuple(result)

    def statement(self, node: ast.stmt) -> list[Statement]:
        match node:
            case ast.Assign(targets=[ast.Name(id=copy)], value=ast.Call(func=ast.Attribute() as method, args=[])):
                return self.copy(node, copy, method)
            case ast.Assign(targets=[ast.Subscript(value=ast.Name(id=name)) as target], value=value) if (
                name in self.copies
            ):
                return self.replace(node, self.copies[name], target, value)
            case ast.Assign(targets=[target], value=value):
                return [self.assign(node, target, value)]
            case ast.AnnAssign(target=ast.Name() as target, value=ast.expr() as value):
                return [self.assign(node, target, value)]
            case ast.If():
                return [self.branch(node)]
            case ast.Expr(value=ast.Call() as call):
                return list(self.inline(call))
            case ast.Expr(value=ast.Constant(value=str())) | ast.Pass():
                return []
        self.refuse(node, "an assignment, if, or a call of name(p, s, i, o)")
        raise AssertionError

    def inline(self, call: ast.Call) -> tuple[Statement, ...]:
        known = {**self.given, **self.copies}
        arguments = [known.get(argument.id) for argument in call.args if isinstance(argument, ast.Name)]
        sections = [argument.section for argument in arguments if argument is not None]
        if not isinstance(call.func, ast.Name) or sections != list(ARRAYS.values()) or call.keywords:
            self.refuse(call, "a call of the form name(p, s, i, o)")
        assert isinstance(call.func, ast.Name)  # noqa: S101
        function = self.known.get(call.func.id)
        if function is None or call.func.id in self.callers:
            self.refuse(call, "a known function that does not call itself")
        given = {letter: array for letter, array in zip(ARRAYS, arguments, strict=True) if array is not None}
        statements = _Function(function, self.table, self.callers, given).statements()
        kept = {name for array in given.values() for name in array.instead.values()}
        if any(isinstance(part, Assign) and part.target in kept for part in every_statement(statements)):
            self.refuse(call, "a kernel that does not change what it reads through a copy")
        return statements

    def copy(self, node: ast.stmt, name: str, method: ast.Attribute) -> list[Statement]:
        """``q = p.copy()``: another name for the section."""
        of = method.value.id if isinstance(method.value, ast.Name) else ""
        if method.attr != "copy" or of not in COPIED or name in ARRAYS or name in self.copies:
            self.refuse(node, f"q = p.copy() or i.copy(), once a name, with no name of {list(ARRAYS)}")
        self.copies[name] = _Array(self.given[of].section, dict(self.given[of].instead))
        return []

    def replace(self, node: ast.stmt, copy: _Array, target: ast.Subscript, value: ast.expr) -> list[Statement]:
        """``q[NAME] = s[OTHER]``: OTHER is read where the next kernel says NAME."""
        place, other = self.variable(target), self.expression(value)
        if node not in self.node.body or not isinstance(other, Name) or other.section != "state":
            self.refuse(node, "q[NAME] = s[OTHER], in every scan")
        assert isinstance(other, Name)  # noqa: S101
        if other.kind != place.kind or place.name in copy.instead:
            self.refuse(node, f"another {place.kind} for {place.name}, once")
        copy.instead[place.name] = other
        return []

    def branch(self, node: ast.If) -> If:
        branches = [(self.condition(node.test), self.body(node.body))]
        rest = node.orelse
        while len(rest) == 1 and isinstance(rest[0], ast.If):
            branches.append((self.condition(rest[0].test), self.body(rest[0].body)))
            rest = rest[0].orelse
        return If(tuple(branches), self.body(rest))

    def condition(self, node: ast.expr) -> Expression:
        result = self.expression(node)
        if result.kind != "bool":
            self.refuse(node, "a condition (compare a flag with 0.0)")
        if any(isinstance(part, ast.BinOp) and isinstance(part.op, ast.Div | ast.Mod) for part in ast.walk(node)):
            self.refuse(node, "no division in a condition (a PLC works out all parts of it)")
        return result

    def assign(self, node: ast.stmt, target: ast.expr, value: ast.expr) -> Assign:
        tree = self.expression(value)
        if isinstance(target, ast.Name):
            name = self.table.local(target.id, self.name)
            seen = self.table.local_kinds.get(name, "literal")
            kind = kinds.common(seen, tree.kind)
            if kind is None:
                self.refuse(node, f"one kind of value in {target.id} (it was {seen})")
            assert kind is not None  # noqa: S101
            self.table.local_kinds[name] = kind
            place = Name("local", name, kind)
        else:
            variable = self.variable(target)
            if variable.section not in WRITABLE:
                self.refuse(node, "an assignment to s[..], o[..] or a local variable")
            place = variable
        stored = kinds.as_kind(tree, place.kind)
        if stored is None:
            self.refuse(node, f"a value that fits {place.kind}, not {tree.kind}")
        assert stored is not None  # noqa: S101
        return Assign(place, stored)

    def variable(self, node: ast.expr) -> Name:
        """Variable of ``a[NAME]``, where constant and table agree on the index."""
        if not (
            isinstance(node, ast.Subscript)
            and isinstance(node.value, ast.Name)
            and node.value.id in {*ARRAYS, *self.copies}
            and isinstance(node.slice, ast.Name)
        ):
            self.refuse(node, "p[NAME], s[NAME], i[NAME] or o[NAME]")
        assert isinstance(node, ast.Subscript)  # noqa: S101
        assert isinstance(node.value, ast.Name)  # noqa: S101
        assert isinstance(node.slice, ast.Name)  # noqa: S101
        array, constant = {**self.given, **self.copies}[node.value.id], node.slice.id
        index, table = self.known.get(constant), self.table.sections[array.section]
        size = len(table)
        if not isinstance(index, int) or not -size <= index < size or table[index].name != constant:
            self.refuse(node, f"an index that the variable table has under {array.section} at this place")
        return Name(array.section, constant, table[index].kind)

    def replaced(self, node: ast.Subscript) -> Name | None:
        """What is read instead of ``a[NAME]``, where a caller said so."""
        assert isinstance(node.value, ast.Name)  # noqa: S101
        assert isinstance(node.slice, ast.Name)  # noqa: S101
        array = self.given.get(node.value.id)
        return None if array is None else array.instead.get(node.slice.id)

    def expression(self, node: ast.expr) -> Expression:
        match node:
            case ast.Constant(value=float() | int() as value) if not isinstance(value, bool):
                if value != int(value) or abs(value) > LARGEST_LITERAL:
                    self.refuse(node, "a whole number (everything else is a parameter or a named constant)")
                return Number(float(value))
            case ast.Name():
                return self.local(node)
            case ast.Subscript():
                variable = self.variable(node)
                return self.replaced(node) or variable
            case _:
                return self.operator(node)

    def operator(self, node: ast.expr) -> Expression:
        match node:
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return self.operation(node, "neg", [operand])
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return Operation("not", (self.condition(operand),), "bool")
            case ast.BoolOp(op=operator, values=values):
                return self.logic("and" if isinstance(operator, ast.And) else "or", values)
            case ast.BinOp(left=left, op=operator, right=right) if type(operator) in ARITHMETIC:
                return self.operation(node, ARITHMETIC[type(operator)], [left, right])
            case ast.Compare(left=left, ops=[operator], comparators=[right]) if type(operator) in COMPARISON:
                return self.operation(node, COMPARISON[type(operator)], [left, right])
            case ast.Call(func=ast.Name(id="min" | "max" as name), args=[left, right], keywords=[]):
                return self.operation(node, name, [left, right])
            case ast.Call(func=ast.Name(id="abs"), args=[operand], keywords=[]):
                return self.operation(node, "abs", [operand])
        self.refuse(node, "+ - * /, a comparison of two, and / or / not, min, max, abs")
        raise AssertionError

    def local(self, node: ast.Name) -> Expression:
        key = self.table.local(node.id, self.name)
        constant = self.known.get(node.id)
        if key not in self.table.local_kinds and isinstance(constant, float):
            if float(np.float32(constant)) != constant:
                self.refuse(node, "a constant that REAL holds exactly")
            return Number(constant)
        if key not in self.table.local_kinds:
            self.refuse(node, "a local variable that has been assigned before")
        return Name("local", key, self.table.local_kinds[key])

    def logic(self, operator: str, values: list[ast.expr]) -> Expression:
        conditions = [self.condition(value) for value in values]
        result = conditions[0]
        for condition in conditions[1:]:
            result = Operation(operator, (result, condition), "bool")
        return result

    def operation(self, node: ast.expr, operator: str, operands: list[ast.expr]) -> Expression:
        trees = [self.expression(operand) for operand in operands]
        result = kinds.operation(operator, trees)
        if result is None:
            self.refuse(node, f"operands that {operator} takes, not {' and '.join(tree.kind for tree in trees)}")
        assert result is not None  # noqa: S101
        return result
