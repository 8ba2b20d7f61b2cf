"""Trees with less in them, for languages that have less: no MIN and MAX, two operands a statement."""

from __future__ import annotations

from dataclasses import replace

from lostmotion.export.tree import (
    ARITHMETIC,
    Assign,
    Block,
    Convert,
    Expression,
    If,
    Name,
    Number,
    Operation,
    Statement,
    each_statement,
)


def without_min_max(block: Block, two_operands: bool = False) -> Block:
    """The same block in IF, arithmetic and ABS; MIN and MAX become a temporary variable and an IF.

    Conversions stand alone, as assignments. With `two_operands` arithmetic inside arithmetic goes through temporary
    variables as well. Conditions are worked out before the IF they belong to, which changes nothing: no expression
    has an effect, and no condition divides.
    """
    lowering = _Lowering(two_operands)
    body = tuple(each_statement(block.body, lowering.statement))
    return replace(block, body=body, local_names=(*block.local_names, *lowering.temporaries))


class _Lowering:
    def __init__(self, two_operands: bool) -> None:
        self.two_operands = two_operands
        self.temporaries: list[Name] = []
        self.before: list[Statement] = []
        self.in_use = 0

    def statement(self, statement: Statement) -> list[Statement]:
        """The statement, after what has to be worked out first. Temporaries are free again after each statement."""
        self.before, self.in_use = [], 0
        if isinstance(statement, Assign):
            value = self.expression(statement.value)
            return [*self.before, Assign(statement.target, value)]
        if isinstance(statement, If):
            branches = tuple((self.expression(condition), body) for condition, body in statement.branches)
            return [*self.before, If(branches, statement.otherwise)]
        return [statement]

    def expression(self, tree: Expression) -> Expression:
        """The expression without what is not allowed."""
        if isinstance(tree, Convert):
            return Convert(self.expression(tree.operand), tree.kind)
        if not isinstance(tree, Operation):
            return tree
        operands = tuple(self.operand(operand, tree) for operand in tree.operands)
        if tree.operator not in ("min", "max"):
            return Operation(tree.operator, operands, tree.kind)
        place = self.temporary(tree.kind)
        sign = "<" if tree.operator == "min" else ">"
        other = Operation(sign, (operands[1], place), "bool")
        self.before += [Assign(place, operands[0]), If(((other, (Assign(place, operands[1]),)),))]
        return place

    def operand(self, tree: Expression, parent: Operation) -> Expression:
        """Operand of `parent`, by way of a temporary variable where it must not be an operation itself."""
        result = self.expression(tree)
        if isinstance(result, Convert):
            return self.keep(result)
        nested = isinstance(result, Operation) and result.operator in (*ARITHMETIC, "neg", "abs")
        split = parent.operator in ("min", "max") or (self.two_operands and parent.kind != "bool")
        compared = self.two_operands and parent.operator in ("<", "<=", ">", ">=", "=", "<>")
        return self.keep(result) if nested and (split or compared) else result

    def keep(self, tree: Expression) -> Name:
        """A temporary variable that holds the value."""
        place = self.temporary(tree.kind)
        self.before.append(Assign(place, tree))
        return place

    def temporary(self, kind: str) -> Name:
        """A temporary variable that this statement does not use yet."""
        same = [name for name in self.temporaries if name.kind == kind]
        name = f"TEMP_{kind.upper()}_{self.in_use + 1}"
        self.in_use += 1
        for candidate in same:
            if candidate.name == name:
                return candidate
        place = Name("local", name, kind)
        self.temporaries.append(place)
        return place


def without_bool_values(block: Block) -> Block:
    """The same block where a flag is only ever given TRUE, FALSE or another flag; a condition becomes an IF."""

    def change(statement: Statement) -> list[Statement]:
        if isinstance(statement, Assign) and statement.target.kind == "bool" and isinstance(statement.value, Operation):
            yes, no = (Assign(statement.target, Number(value, "bool")) for value in (1.0, 0.0))
            return [If(((statement.value, (yes,)),), (no,))]
        return [statement]

    return replace(block, body=tuple(each_statement(block.body, change)))
