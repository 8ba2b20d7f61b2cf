"""From kernel to tree: what is taken, what is refused, and what it looks like in ST."""

import pytest

from lostmotion.compensate.variables import Variable
from lostmotion.errors import ParameterError
from lostmotion.export.dialects.structured_text import syntax
from lostmotion.export.lower import without_bool_values, without_min_max
from lostmotion.export.names import LONGEST, block_name, plc_names
from lostmotion.export.printer import Printer
from lostmotion.export.reserved import why_reserved
from lostmotion.export.translate import translate
from lostmotion.export.tree import Assign, If, Name, Operation, parts

WIDTH, SCANS, HOLD = range(3)
OP_IN, ENABLE = range(2)
OP_OUT, COUNT, HIGH_ALARM = range(3)
LAST, TURNS, WAS_ON, FROM = range(4)
MISPLACED = 0

TABLE = (
    Variable("WIDTH", "parameter", "real", "%", "width"),
    Variable("SCANS", "parameter", "int", "", "scans"),
    Variable("HOLD", "parameter", "bool", "", "hold"),
    Variable("OP_IN", "input", "real", "%", "input"),
    Variable("ENABLE", "input", "bool", "", "enable"),
    Variable("OP_OUT", "output", "real", "%", "output"),
    Variable("COUNT", "output", "int", "", "count"),
    Variable("HIGH_ALARM", "output", "bool", "", "alarm"),
    Variable("LAST", "state", "real", "%", "last"),
    Variable("TURNS", "state", "int", "", "turns"),
    Variable("WAS_ON", "state", "bool", "", "was on"),
    Variable("FROM", "state", "real", "", "a reserved word"),
)


def helper(p, s, i, o):
    """Count (* scans *)."""
    x = s[LAST] - i[OP_IN]
    if x < -p[WIDTH] and not i[ENABLE] == 0.0:  # noqa: SIM201
        s[TURNS] = s[TURNS] + 1.0
    elif s[TURNS] >= p[SCANS]:
        s[TURNS] = 0.0


def every_construct(p, s, i, o):
    """Every construct."""
    x = i[OP_IN] * p[WIDTH] / (p[WIDTH] - (s[LAST] - p[WIDTH]))
    high = x > p[WIDTH]
    two = 1.0 + 1.0
    helper(p, s, i, o)
    if i[OP_IN] != i[OP_IN]:
        x = min(max(-x, 0.0), abs(s[FROM])) + p[SCANS]
    elif (i[ENABLE] != 0.0 or p[HOLD] == 0.0) and s[WAS_ON] != i[ENABLE]:
        x = -(x + s[TURNS] * p[WIDTH])
    else:
        pass
    s[WAS_ON] = i[ENABLE]
    s[LAST] = x
    s[FROM] = two
    o[OP_OUT] = x - (1.0 - x)
    o[COUNT] = s[TURNS]
    o[HIGH_ALARM] = high


def lines(function, real="lreal", lower=False):
    block = translate(function, TABLE)
    if lower:
        block = without_bool_values(without_min_max(block, two_operands=True))
    variables = [Name(variable.section, variable.name, variable.kind) for variable in TABLE]
    names = plc_names([*variables, *block.local_names])
    return Printer(syntax(real), names).lines(block.body)


def test_every_construct_in_structured_text():
    assert lines(every_construct) == [
        "(* Every construct. *)",
        "x := op_in * width / (width - (last - width));",
        "high := x > width;",
        "two := 2.0;",
        "(* Count (* scans *). *)",
        "x_helper := last - op_in;",
        "IF (x_helper < (-width)) AND (NOT (NOT enable)) THEN",
        "    turns := turns + 1;",
        "ELSIF turns >= scans THEN",
        "    turns := 0;",
        "END_IF;",
        "IF op_in <> op_in THEN",
        "    x := MIN(MAX(-x, 0.0), ABS(kept_from)) + DINT_TO_LREAL(scans);",
        "ELSIF (enable OR (NOT hold)) AND (was_on <> enable) THEN",
        "    x := -(x + (DINT_TO_LREAL(turns) * width));",
        "END_IF;",
        "was_on := enable;",
        "last := x;",
        "kept_from := two;",
        "op_out := x - (1.0 - x);",
        "count := turns;",
        "high_alarm := high;",
    ]


def test_constants_in_real_arithmetic_have_a_type():
    assert "op_out := x - (REAL#1.0 - x);" in lines(every_construct, "real")


def expressions(statements):
    """Every expression of the statements, the parts of expressions included."""
    for statement in statements:
        if isinstance(statement, Assign):
            yield from parts(statement.value)
        elif isinstance(statement, If):
            for condition, body in statement.branches:
                yield from parts(condition)
                yield from expressions(body)
            yield from expressions(statement.otherwise)


def test_lowered_tree_has_two_operands_and_no_min_max():
    block = without_bool_values(without_min_max(translate(every_construct, TABLE), two_operands=True))
    arithmetic = {"+", "-", "*", "/", "neg", "abs"}
    for tree in expressions(block.body):
        if isinstance(tree, Operation):
            assert tree.operator not in ("min", "max")
            if tree.operator in arithmetic:
                inner = [getattr(operand, "operator", "") for operand in tree.operands]
                assert not arithmetic & set(inner), tree
    text = "\n".join(lines(every_construct, lower=True))
    assert "high := TRUE;" in text
    assert "MIN" not in text


def loop(p, s, i, o):
    for _ in range(2):
        s[LAST] = 0.0


def returns(p, s, i, o):
    return


def augmented(p, s, i, o):
    s[LAST] += 1.0


def chained(p, s, i, o):
    s[LAST] = s[FROM] = 0.0


def writes_input(p, s, i, o):
    i[OP_IN] = 0.0


def index_number(p, s, i, o):
    s[0] = 0.0


def wrong_section(p, s, i, o):
    s[MISPLACED] = 0.0


def power(p, s, i, o):
    s[LAST] = s[FROM] ** 2.0


def fraction(p, s, i, o):
    s[LAST] = s[FROM] * 0.5


def sine(p, s, i, o):
    s[LAST] = round(s[FROM])


def either(p, s, i, o):
    s[LAST] = s[FROM] if s[FROM] > 0.0 else 0.0


def double_comparison(p, s, i, o):
    if 0.0 < s[LAST] < p[WIDTH]:
        s[LAST] = 0.0


def flag_in_arithmetic(p, s, i, o):
    s[LAST] = s[WAS_ON] * p[WIDTH]


def real_as_condition(p, s, i, o):
    if s[LAST]:
        s[LAST] = 0.0


def division_in_condition(p, s, i, o):
    if p[WIDTH] != 0.0 and s[LAST] / p[WIDTH] > 1.0:
        s[LAST] = 0.0


def before_assignment(p, s, i, o):
    if i[OP_IN] > 0.0:
        y = i[OP_IN]
    s[LAST] = y


def output_left(p, s, i, o):
    o[OP_OUT] = 0.0
    o[COUNT] = 0.0
    if i[OP_IN] > 0.0:
        o[HIGH_ALARM] = 1.0


def output_read(p, s, i, o):
    s[LAST] = o[OP_OUT]


def itself(p, s, i, o):
    itself(p, s, i, o)


def other_order(p, s, i, o):
    helper(s, p, i, o)


def unknown_call(p, s, i, o):
    nowhere(p, s, i, o)  # noqa: F821


def flag_of_two(p, s, i, o):
    s[WAS_ON] = 1.0 + 1.0


def two_kinds(p, s, i, o):
    y = s[LAST] > 0.0
    y = s[LAST]
    s[FROM] = y


REFUSED = [
    loop, returns, augmented, chained, writes_input, index_number, wrong_section, power, fraction, sine, either,
    double_comparison, flag_in_arithmetic, real_as_condition, division_in_condition, before_assignment, output_left,
    output_read, itself, other_order, unknown_call, flag_of_two, two_kinds,
]  # fmt: skip


@pytest.mark.parametrize("function", REFUSED, ids=lambda function: function.__name__)
def test_anything_else_is_refused(function):
    with pytest.raises(ParameterError, match=r"expected .*, got .*; "):
        translate(function, TABLE)


def test_a_refusal_names_function_line_and_construct():
    line = power.__code__.co_firstlineno + 1
    with pytest.raises(ParameterError, match=rf"`s\[FROM\] \*\* 2.0` \(power, line {line}\)"):
        translate(power, TABLE)


@pytest.mark.parametrize("name", ["1st", "a__b", "a_", "a-b", "x" * (LONGEST + 1), "step", "EN", "müller", ""])
def test_names_that_a_tool_would_not_take(name):
    with pytest.raises(ParameterError):
        block_name(name)


def test_reserved_words_get_a_prefix():
    names = plc_names([Name("state", word.upper(), "real") for word in ("limit", "en", "step")])
    assert sorted(names.values()) == ["kept_en", "kept_limit", "kept_step"]
    assert not any(why_reserved(name) for name in names.values())
