"""Supervised blocks as files: names, page, vectors, settings, and what the translator takes and refuses for them."""

import csv
import io
import re

import numpy as np
import pytest

from lostmotion.compensate.request import Request
from lostmotion.compensate.supervised import SUPERVISED, SupervisedBlock
from lostmotion.compensate.supervision_variables import supervision
from lostmotion.compensate.variables import SECTIONS, Variable
from lostmotion.errors import ParameterError
from lostmotion.export import TARGETS, export
from lostmotion.export.dialects import restore
from lostmotion.export.reader import Program
from lostmotion.export.reserved import why_reserved
from lostmotion.export.translate import translate
from lostmotion.kernels.blocks.supervised import supervisor
from tests.support.exports import KINDS, block
from tests.support.supervised import source, supervised


@pytest.mark.parametrize("kind", KINDS)
def test_table_and_kernel_have_the_same_order(kind):
    specification = SUPERVISED[kind]
    own = {variable.name for variable in supervision("", "")}
    for section in SECTIONS:
        names = [variable.name for variable in specification.section(section)]
        for place, name in enumerate(names):
            owner = supervisor if name in own else specification.module
            if hasattr(owner, name):
                assert getattr(owner, name) % len(names) == place, name
            assert specification.index(name) == place or section == "state"
    assert own <= {variable.name for variable in specification.variables}
    assert len(set(specification.variables)) == len(specification.variables)


@pytest.mark.parametrize("to", TARGETS)
@pytest.mark.parametrize("kind", KINDS)
def test_names_that_every_tool_takes(kind, to):
    program = Program(restore(TARGETS[to].files(source(kind, "real"))))
    for name in program.variables:
        assert re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name), name
        assert len(name) <= 32
        assert why_reserved(name) is None, name
    for variable in SUPERVISED[kind].variables:
        if variable.section != "state":
            assert variable.name.lower() in program.variables


def test_the_plain_block_is_as_it_was():
    (text,) = TARGETS["st"].files(source("backlash")).values()
    assert "request_id" in text
    (plain,) = export(block("backlash"), "st", name="FY_101", date="2026-01-31").code.values()
    assert "request_id" not in plain
    assert "Supervised" not in plain


@pytest.mark.parametrize("to", TARGETS)
def test_the_header_says_it(to):
    done = export(block("backlash"), to, name="FY_101", date="2026-01-31", supervised={"timeout": 20})
    assert all("Supervised: compensates only with" in text for text in done.code.values())
    assert done.source.values["timeout"] == 20.0
    page = done.files["FY_101_commissioning.md"]
    for said in ("`accept`", "never", "lead_up", "lead_down", "20 scans (2 s)", "`shed_reason` 2", "block_key"):
        assert said in page, said
    assert done.replay(rows=300).agrees


@pytest.mark.parametrize("kind", KINDS)
def test_vectors_show_a_request_and_its_accept(kind):
    done = export(block(kind), "st", name="FY_101", date="2026-01-31", supervised=True)
    rows = list(csv.DictReader(io.StringIO(done.files["FY_101_vectors.csv"])))
    assert {"1", "3"} <= {row["supervision"] for row in rows}
    program = Program(restore(done.code))
    columns = [variable.name.lower() for variable in done.source.specification.section("input")]
    inputs = np.array([[float(row[name]) for name in columns] for row in rows])
    found = program.run({}, columns, inputs, ["op_out", "supervision"])
    np.testing.assert_allclose(found[:, 0], [float(row["op_out"]) for row in rows], rtol=1e-12)
    np.testing.assert_array_equal(found[:, 1], [float(row["supervision"]) for row in rows])


def test_blocks_of_other_names_have_other_keys():
    keys = {
        export(block("backlash"), "st", name=name, date="2026-01-31", supervised=True).source.values["block_key"]
        for name in ("FY_101", "FY_102")
    }
    assert len(keys) == 2


@pytest.mark.parametrize(
    "settings",
    [{"timeout": 0}, {"timeout": 1.5}, {"resolution": 0.0}, {"first_range": float("nan")}, {"block_key": 524287.0},
     {"timeuot": 3}, {"most_change": -1.0}],
)  # fmt: skip
def test_bad_settings(settings):
    with pytest.raises(ParameterError):
        supervised("backlash", **settings)


def test_saved_and_read():
    made = supervised("dead zone")
    assert SupervisedBlock.from_dict(made.to_dict()) == made


@pytest.mark.parametrize("numbers", [(0, 1, 1, 1), (1, 4_000_001, 1, 1), (1, 1.5, 1, 1), (1, 1, 1, 1, 524287)])
def test_bad_requests(numbers):
    with pytest.raises(ParameterError):
        Request(*numbers)


def test_any_one_number_changes_the_checksum():
    random = np.random.default_rng(0)
    for _ in range(2_000):
        numbers = [int(n) for n in random.integers(1, 400_000, size=4)]
        other = list(numbers)
        k = int(random.integers(4))
        other[k] = int(random.integers(1, 400_000))
        assert (Request(*numbers).checksum == Request(*other).checksum) == (numbers == other)


WIDTH = OP_IN = OP_OUT = LAST = 0
OTHER = -1
TABLE = (
    Variable("WIDTH", "parameter", "real", "", "w"),
    Variable("OP_IN", "input", "real", "", "i"),
    Variable("OP_OUT", "output", "real", "", "o"),
    Variable("LAST", "state", "real", "", "l"),
    Variable("OTHER", "state", "real", "", "x"),
)


def inner(p, s, i, o):
    """Reads WIDTH."""
    o[OP_OUT] = p[WIDTH] + i[OP_IN]


def writes(p, s, i, o):
    """Writes what is read through the copy."""
    s[OTHER] = 1.0
    o[OP_OUT] = p[WIDTH]


def good(p, s, i, o):
    """In front."""
    q = p.copy()
    q[WIDTH] = s[OTHER]
    inner(q, s, i, o)


def only_sometimes(p, s, i, o):
    """In a branch."""
    q = p.copy()
    if i[OP_IN] > 0.0:
        q[WIDTH] = s[OTHER]
    inner(q, s, i, o)


def changed_inside(p, s, i, o):
    """The inner kernel writes it."""
    q = p.copy()
    q[WIDTH] = s[OTHER]
    writes(q, s, i, o)


def wrong_order(p, s, i, o):
    """Arrays exchanged."""
    inner(i, s, p, o)


def not_a_state(p, s, i, o):
    """From an expression."""
    q = p.copy()
    q[WIDTH] = s[OTHER] + 1.0
    inner(q, s, i, o)


def modulus_of_reals(p, s, i, o):
    """MOD is for whole numbers."""
    o[OP_OUT] = i[OP_IN] % 3.0


def test_a_copy_is_read_where_the_inner_kernel_reads_the_setting():
    assert translate(good, TABLE).body[-1].value.operands[0].name == "OTHER"


@pytest.mark.parametrize("kernel", [only_sometimes, changed_inside, wrong_order, not_a_state, modulus_of_reals])
def test_what_a_copy_may_not_be(kernel):
    with pytest.raises(ParameterError):
        translate(kernel, TABLE)
