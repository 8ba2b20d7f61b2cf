"""Exported code compiled and executed by tools that are not ours: ST machine, C compiler, parsers, PLCopen schema."""

import re
import subprocess

import numpy as np
import pytest

from lostmotion.export import TARGETS
from lostmotion.export.dialects import restore
from lostmotion.export.replay import compare, expected
from lostmotion.export.scenarios import scenario
from tests.plc.machine import (
    PYTHON,
    ROOT,
    SANITIZE,
    SCHEMA,
    DoesNotCompileError,
    Machine,
    need,
    run_in_c,
    run_in_machine,
)
from tests.support.exports import KINDS, REALS, source

pytestmark = [pytest.mark.long, pytest.mark.statistics]
ROWS = 30_000
BOTH = [(kind, real) for kind in KINDS for real in REALS]


@pytest.fixture(scope="module")
def run_of():
    """Scenario and the kernel's outputs, once a kind."""
    cache = {}

    def get(kind, real, rows):
        if (kind, real, rows) not in cache:
            one = source(kind, real)
            stretches = scenario(one.specification, one.parameters, rows, seed=1)
            cache[kind, real, rows] = one, stretches, expected(one, stretches)
        return cache[kind, real, rows]

    return get


def agree(one, kernel, found):
    proof = compare(one, kernel, found)
    assert proof.agrees, proof.summary()


@pytest.mark.parametrize(("kind", "real"), BOTH)
def test_st_in_the_machine(run_of, kind, real):
    one, stretches, kernel = run_of(kind, real, ROWS)
    agree(one, kernel, run_in_machine(restore(TARGETS["st"].files(one)), one, stretches))


@pytest.mark.parametrize("to", ["plcopen", "tcpou", "scl", "l5x"])
@pytest.mark.parametrize(("kind", "real"), BOTH)
def test_other_dialects_turned_back_in_the_machine(run_of, kind, real, to):
    one, stretches, kernel = run_of(kind, real, ROWS)
    some = stretches[:500]
    rows = sum(len(stretch.inputs) for stretch in some)
    agree(one, kernel[:rows], run_in_machine(restore(TARGETS[to].files(one)), one, some))


@pytest.mark.parametrize(("kind", "real"), BOTH)
def test_c_by_a_compiler(run_of, kind, real, tmp_path):
    one, stretches, kernel = run_of(kind, real, ROWS)
    agree(one, kernel, run_in_c(TARGETS["c"].files(one), one, stretches, tmp_path))


@pytest.mark.parametrize(("kind", "real"), BOTH)
def test_c_with_sanitizers(run_of, kind, real, tmp_path):
    one, stretches, kernel = run_of(kind, real, ROWS)
    agree(one, kernel, run_in_c(TARGETS["c"].files(one), one, stretches, tmp_path, SANITIZE))


@pytest.mark.parametrize("real", REALS)
def test_every_answer_is_visited(run_of, real):
    for kind in KINDS:
        one, _, kernel = run_of(kind, real, ROWS)
        columns = {v.name: kernel[:, k] for k, v in enumerate(one.specification.section("output"))}
        assert set(columns["STATE"]) == {0.0, 1.0, 2.0, 3.0, 4.0}
        assert set(columns["DIRECTION"]) == {-1.0, 0.0, 1.0}
        assert set(columns["ERROR"]) == {0.0, 1.0, 2.0, 3.0}
        for flag in ("LIMITED_LOW", "LIMITED_HIGH", "OFFSET_CAPPED", "RAMPING"):
            assert set(columns[flag]) == {0.0, 1.0}
            assert columns[flag].mean() > 1e-3
        assert (columns["STATE"] == 2.0).mean() > 0.2
        assert np.isfinite(kernel).all()


def test_a_wrong_operator_is_seen_by_the_machine(run_of):
    one, stretches, kernel = run_of("dead zone", "lreal", ROWS)
    text = restore(TARGETS["st"].files(one))
    for old, new in (("sensed < extreme - used_band", "sensed <= extreme - used_band"), ("MIN(MAX(", "MIN(MIN(")):
        assert old in text
        assert not compare(one, kernel, run_in_machine(text.replace(old, new), one, stretches)).agrees


def test_the_machine_refuses_what_is_wrong():
    text = restore(TARGETS["st"].files(source("backlash")))
    for old, new in (
        ("END_IF;", "END_I;"),
        ("started : BOOL;", "started : LREAL;"),
        ("error := fault", "error := base"),
    ):
        with pytest.raises(DoesNotCompileError):
            Machine(text.replace(old, new))


@pytest.fixture(scope="module")
def parse():
    need(PYTHON, SCHEMA)

    def run(*paths):
        script = ROOT / "tests" / "plc" / "parse.py"
        done = subprocess.run([PYTHON, script, *paths], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr

    return run


@pytest.mark.parametrize(("kind", "real"), BOTH)
def test_plcopen_by_the_schema(parse, tmp_path, kind, real):
    (text,) = TARGETS["plcopen"].files(source(kind, real, data='<&"]]>')).values()
    path = tmp_path / "block.xml"
    path.write_text(text, encoding="utf-8")
    assert parse(path) == (0, "")


def test_parsers_that_are_not_ours(parse, tmp_path):
    paths = []
    for to, kind, real in (("st", "dead zone", "real"), ("tcpou", "backlash", "lreal")):
        ((name, text),) = TARGETS[to].files(source(kind, real)).items()
        paths.append(tmp_path / name)
        paths[-1].write_text(text, encoding="utf-8")
    assert parse(*paths) == (0, "")


def test_parsers_see_what_is_wrong(parse, tmp_path):
    (text,) = TARGETS["plcopen"].files(source("backlash")).values()
    (tmp_path / "bad.xml").write_text(text.replace("<dataTypes/>", ""), encoding="utf-8")
    (text,) = TARGETS["st"].files(source("backlash")).values()
    (tmp_path / "bad.st").write_text(re.sub(r"THEN", "THEM", text, count=1), encoding="utf-8")
    for path in tmp_path.iterdir():
        code, said = parse(path)
        assert code == 1
        assert path.name in said
