"""Which kinds go together, and the conversions that a PLC wants written out."""

from __future__ import annotations

from collections.abc import Sequence

from lostmotion.export.tree import COMPARISONS, Convert, Expression, Number, Operation

RANK = {"literal": 0, "int": 1, "real": 2}


def common(left: str, right: str) -> str | None:
    """Kind that holds both, or None."""
    if left == right:
        return left
    if "bool" in (left, right):
        return "bool" if "literal" in (left, right) else None
    return max(left, right, key=RANK.__getitem__)


def as_kind(tree: Expression, kind: str) -> Expression | None:
    """The value as another kind; None where that would lose something."""
    if tree.kind == kind:
        return tree
    if isinstance(tree, Number):
        return Number(tree.value, kind) if kind != "bool" or tree.value in (0.0, 1.0) else None
    if (tree.kind, kind) == ("real", "bool"):  # flags are stored as 0.0 and 1.0
        return Operation("<>", (tree, Number(0.0, "real")), "bool")
    if (tree.kind, kind) in (("int", "real"), ("real", "int")):
        return Convert(tree, kind)
    return tree if tree.kind == "literal" or kind == "literal" else None


def operation(operator: str, trees: Sequence[Expression]) -> Expression | None:
    """Operator on operands that were given one kind; None where they have none."""
    numbers = [tree.value for tree in trees if isinstance(tree, Number)]
    if operator == "neg" and numbers:
        return Number(-numbers[0])
    if operator in ("+", "-") and len(numbers) == len(trees) == 2:
        return Number(numbers[0] + numbers[1] if operator == "+" else numbers[0] - numbers[1])
    if any(tree.kind == "bool" for tree in trees):
        return _flags(operator, trees)
    kind = "literal"
    for tree in trees:
        kind = common(kind, tree.kind) or kind
    if operator == "%":
        return _remainder(trees, kind)
    if operator == "/" or (kind == "int" and not numbers and operator in ("+", "-", "*", "abs", "neg")):
        kind = "real"  # what an int could not hold; counting (a literal added) stays in whole numbers
    operands = [as_kind(tree, kind) for tree in trees]
    result = "bool" if operator in COMPARISONS else kind
    return Operation(operator, tuple(operand for operand in operands if operand is not None), result)


def _remainder(trees: Sequence[Expression], kind: str) -> Expression | None:
    """MOD of a whole number and a constant above 0; what is divided must not be negative, or dialects differ."""
    modulus = as_kind(trees[1], "int")
    if kind != "int" or not isinstance(modulus, Number) or modulus.value <= 0.0:
        return None
    return Operation("%", (trees[0], modulus), "int")


def _flags(operator: str, trees: Sequence[Expression]) -> Expression | None:
    """Comparison of a flag with 0.0, 1.0 or another flag."""
    if operator not in ("=", "<>"):
        return None
    flags = [tree for tree in trees if tree.kind == "bool"]
    numbers = [tree for tree in trees if isinstance(tree, Number)]
    if len(flags) == 2:
        return Operation(operator, tuple(flags), "bool")
    if not numbers or numbers[0].value not in (0.0, 1.0):
        return None
    true = (operator == "=") == (numbers[0].value == 1.0)
    return flags[0] if true else Operation("not", (flags[0],), "bool")
