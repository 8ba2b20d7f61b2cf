"""The replay in plain Python: every dialect agrees with the kernel, and one wrong token does not."""

import os

import numpy as np
import pytest

from lostmotion.errors import DataError
from lostmotion.export import TARGETS, reader, replay
from lostmotion.export.reader import Program
from lostmotion.export.replay import compare
from tests.plc.mutants import mutants
from tests.support.exports import KINDS, REALS, source

ROWS = 500 if os.environ.get("NUMBA_DISABLE_JIT") else 5_000


@pytest.mark.sampled(10)
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("to", TARGETS)
@pytest.mark.parametrize("kind", KINDS)
def test_every_dialect_agrees_with_the_kernel(kind, to, real):
    one = source(kind, real)
    proof = replay(TARGETS[to].files(one), one, rows=ROWS if to in ("st", "l5x") else ROWS // 4)
    assert proof.agrees, proof.summary()
    assert proof.worst == 0.0


# One wrong token each, as a wrong table of operators, a lost sign or lost parentheses would give it.
WRONG = {
    "st": [
        ("sensed < extreme - used_band", "sensed <= extreme - used_band"),
        ("sensed > extreme + used_band", "sensed >= extreme + used_band"),
        ("distance < (-allowed)", "distance < allowed"),
        ("MAX(applied, -used_cap)", "MAX(applied, used_cap)"),
        ("started := TRUE;", "started := FALSE;"),
        ("applied := applied - allowed;", "applied := applied + allowed;"),
        ("turns := turns + 1;", "turns := turns + 2;"),
        ("combined := base + applied;", "combined := base;"),
        ("error := fault;", "error := 0;"),
    ],
    "c": [
        ("s->sensed < s->extreme - s->used_band", "s->sensed <= s->extreme - s->used_band"),
        ("s->combined > s->used_high", "s->combined < s->used_high"),
        ("-s->allowed", "s->allowed"),
        ("lesser(greater(", "lesser(lesser("),
        ("(s->used_shape == 1) && (s->knee > 0.0)", "(s->used_shape != 1) && (s->knee > 0.0)"),
    ],
    "scl": [("-#allowed", "#allowed"), ("MIN(IN1", "MAX(IN1"), ("#combined < #used_low", "#combined > #used_low")],
    "l5x": [
        ("error := fault;", "error := side;"),
        ("started := 1;", "started := 0;"),
        ("base + applied", "base - applied"),
    ],
}
CASES = [(to, old, new) for to, changes in WRONG.items() for old, new in changes]


@pytest.mark.sampled(4)
@pytest.mark.statistics
@pytest.mark.parametrize(("to", "old", "new"), CASES)
def test_one_wrong_token_is_caught(to, old, new):
    one = source("dead zone")
    files = TARGETS[to].files(one)
    wrong = {name: text.replace(old, new, 1) for name, text in files.items()}
    assert wrong != files
    proof = replay(wrong, one)
    assert not proof.agrees
    assert proof.first is not None
    assert "DIFFERS" in proof.summary()


@pytest.mark.statistics
def test_most_single_mutations_are_caught():
    one = source("backlash")
    (text,) = TARGETS["st"].files(one).values()
    chosen = list(mutants(text))[::15]
    assert len(chosen) > 15
    missed = [what for what, wrong in chosen if replay({"FY_101.st": wrong}, one, rows=4000).agrees]
    assert len(missed) < 0.4 * len(chosen), missed  # many are equivalent: ABS in a sum that is only tested for NaN


def test_compare_sees_each_kind_of_difference():
    one = source("backlash")
    names = [variable.name for variable in one.specification.section("output")]
    kernel = np.ones((3, len(names)))
    assert compare(one, kernel, kernel.copy()).agrees
    for name, value in (
        ("OP_OUT", 1.0 + 1e-9),
        ("OP_OUT", np.nan),
        ("OFFSET", np.inf),
        ("STATE", 2.0),
        ("RAMPING", 0.0),
    ):
        other = kernel.copy()
        other[1, names.index(name)] = value
        found = compare(one, kernel, other)
        assert not found.agrees
        assert name in found.first
    close = kernel.copy()
    close[1, names.index("OP_OUT")] += 1e-13
    assert compare(one, kernel, close).agrees
    assert compare(one, kernel, close).worst > 0.0


@pytest.mark.parametrize(
    "text",
    [
        "FUNCTION_BLOCK x VAR a : REAL; a : REAL; END_VAR END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK x VAR a : REAL; END_VAR b := 1.0; END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK x VAR a : REAL; END_VAR a := SIN(a); END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK x VAR a : REAL; END_VAR a := 1.0 END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK x VAR a : REAL; END_VAR IF a > 0.0 THEN a := 1.0;",
        "FUNCTION_BLOCK x VAR a : REAL; END_VAR a := 'text'; END_FUNCTION_BLOCK",
    ],
)
def test_the_reader_refuses_what_is_no_such_st(text):
    with pytest.raises(DataError):
        Program(text)


def test_the_reader_ranks_operators_as_st_does():
    text = """FUNCTION_BLOCK x
    VAR_INPUT a : LREAL; b : LREAL; f : BOOL; END_VAR VAR_OUTPUT r : LREAL; g : BOOL; h : BOOL; END_VAR
    r := a - b - a * b / -b + MAX(a, b); g := NOT f AND a < b OR f; h := a = b XOR f AND TRUE; END_FUNCTION_BLOCK"""
    program = Program(text)
    found = program.run({}, ["a", "b", "f"], [[2.0, 3.0, 1.0], [3.0, 3.0, 0.0], [5.0, 2.0, 0.0]], ["r", "g", "h"])
    assert found.tolist() == [[4.0, 1.0, 1.0], [6.0, 0.0, 1.0], [13.0, 0.0, 0.0]]


@pytest.mark.sampled(4)
@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_what_plcs_do_differently_never_happens(kind, real, monkeypatch):
    """MIN and MAX of NaN differ between PLCs, and a division by zero stops some of them."""

    def no_nan(function):
        def checked(a, b):
            assert not np.isnan([a, b]).any()
            return function(a, b)

        return checked

    monkeypatch.setattr(reader, "_min", no_nan(reader._min))
    monkeypatch.setattr(reader, "_max", no_nan(reader._max))
    with_division = np.errstate
    monkeypatch.setattr(np, "errstate", lambda **_: with_division(all="ignore", divide="raise"))
    one = source(kind, real)
    assert replay(TARGETS["st"].files(one), one, rows=ROWS, seed=3).agrees
