"""Any expression, printed and read back, has the value of its tree: precedence, parentheses, signs, lowering."""

import operator

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lostmotion.export.dialects.structured_text import syntax
from lostmotion.export.lower import without_bool_values, without_min_max
from lostmotion.export.printer import Printer
from lostmotion.export.reader import Program
from lostmotion.export.tree import COMPARISONS, Assign, Block, Name, Number, Operation

REALS = [Name("input", letter, "real") for letter in "ABC"]
FLAGS = [Name("input", letter, "bool") for letter in "FG"]
OUT = {"real": Name("output", "R", "real"), "bool": Name("output", "Q", "bool")}
PYTHON = {
    "+": operator.add, "-": operator.sub, "*": operator.mul, "<": operator.lt, "<=": operator.le, ">": operator.gt,
    ">=": operator.ge, "=": operator.eq, "<>": operator.ne, "and": lambda a, b: a and b, "or": lambda a, b: a or b,
    "not": operator.not_, "neg": operator.neg, "abs": abs, "min": lambda a, b: b if b < a else a,
    "max": lambda a, b: b if b > a else a,
}  # fmt: skip


def operation(name, kind):
    return lambda *operands: Operation(name, operands, kind)


leaves = st.sampled_from([*REALS, Number(0.0, "real"), Number(1.0, "real"), Number(-1.0, "real")])
reals = st.recursive(
    leaves,
    lambda inner: st.one_of(
        *(st.builds(operation(name, "real"), inner, inner) for name in ("+", "-", "*", "min", "max")),
        *(st.builds(operation(name, "real"), inner) for name in ("neg", "abs")),
    ),
    max_leaves=12,
)
conditions = st.recursive(
    st.one_of(st.sampled_from(FLAGS), *(st.builds(operation(name, "bool"), reals, reals) for name in COMPARISONS)),
    lambda inner: st.one_of(
        *(st.builds(operation(name, "bool"), inner, inner) for name in ("and", "or", "=", "<>")),
        st.builds(operation("not", "bool"), inner),
    ),
    max_leaves=6,
)
values = st.lists(st.sampled_from([-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 3.0]), min_size=3, max_size=3)


def value(tree, known):
    if isinstance(tree, Name):
        return known[tree.name]
    if isinstance(tree, Number):
        return tree.value
    return PYTHON[tree.operator](*(value(operand, known) for operand in tree.operands))


def printed_value(tree, known, lower):
    block = Block((Assign(OUT[tree.kind], tree),))
    if lower:
        block = without_bool_values(without_min_max(block, two_operands=True))
    every = [*REALS, *FLAGS, *OUT.values(), *block.local_names]
    names = {name: f"v_{name.name.lower()}" for name in every}
    types = {"real": "LREAL", "bool": "BOOL"}
    declared = "\n".join(f"{names[name]} : {types[name.kind]};" for name in every)
    body = "\n".join(Printer(syntax("lreal"), names).lines(block.body))
    program = Program(f"FUNCTION_BLOCK x\nVAR\n{declared}\nEND_VAR\n{body}\nEND_FUNCTION_BLOCK")
    columns = [names[name] for name in (*REALS, *FLAGS)]
    return program.run({}, columns, [[known[name.name] for name in (*REALS, *FLAGS)]], [names[OUT[tree.kind]]])[0, 0]


@given(st.one_of(reals, conditions), values, st.booleans(), st.booleans(), st.booleans())
def test_printed_and_read_back(tree, numbers, f, g, lower):
    known = dict(zip("ABC", numbers, strict=True)) | {"F": f, "G": g}
    np.testing.assert_equal(printed_value(tree, known, lower), float(value(tree, known)))
