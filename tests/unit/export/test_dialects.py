"""A dialect is one module with all its parts, and every place that knows dialects knows all of them."""

import json
from dataclasses import fields, replace

import pytest
import typer
from typer.testing import CliRunner

from lostmotion.cli import app
from lostmotion.errors import ParameterError
from lostmotion.export import TARGETS, Dialect, export, register, replay
from lostmotion.export.dialects import restore
from tests.support.exports import KINDS, REALS, block, source
from tests.support.places import ROOT
from tests.support.toy_dialect import TOY


@pytest.fixture
def toy():
    register(TOY)
    yield TOY
    del TARGETS["toy"]


@pytest.mark.parametrize("real", REALS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_dialect_from_outside_goes_through_export_replay_and_page(toy, kind, real):
    done = export(block(kind), "toy", name="FY_101", date="2026-01-31", real=real)
    assert list(done.files) == ["FY_101.toy", "FY_101_vectors.csv", "FY_101_commissioning.md"]
    assert "Read it aloud." in done.files["FY_101_commissioning.md"]
    proof = done.replay(rows=2000)
    assert proof.agrees, proof.summary()
    assert proof.worst == 0.0


def test_a_wrong_word_of_a_dialect_from_outside_is_caught(toy):
    one = source("dead zone")
    wrong = {name: text.replace("base + applied", "base - applied") for name, text in toy.files(one).items()}
    assert not replay(wrong, one, rows=2000).agrees


def test_the_command_line_takes_it(toy, tmp_path):
    saved = tmp_path / "block.json"
    saved.write_text(json.dumps(block("backlash").to_dict()), encoding="utf-8")
    words = ["export", str(saved), "--to", "toy", "--name", "FY_101", "--date", "2026-01-31", "--out", str(tmp_path)]
    done = CliRunner().invoke(app, [*words, "--replay", "200"])
    assert done.exit_code == 0, done.output
    assert (tmp_path / "FY_101.toy").exists()


@pytest.mark.parametrize("part", [item.name for item in fields(Dialect)])
def test_a_dialect_without_a_part_cannot_be_made(part):
    parts = {item.name: getattr(TOY, item.name) for item in fields(Dialect) if item.name != part}
    with pytest.raises(TypeError, match=part):
        Dialect(**parts)
    with pytest.raises(ParameterError, match=part):
        replace(TOY, **{part: type(getattr(TOY, part))() if not callable(getattr(TOY, part)) else None})


def test_names_and_endings_are_not_shared(toy):
    for other in (TOY, replace(TOY, name="other"), replace(TOY, endings=("other",)), replace(TOY, endings=("c", "x"))):
        with pytest.raises(ParameterError, match="of its own"):
            register(other)
    assert list(TARGETS)[-1] == "toy"


@pytest.mark.parametrize("to", TARGETS)
def test_files_have_the_endings_that_the_dialect_names(to):
    assert sorted(TARGETS[to].files(source("backlash"))) == sorted(f"FY_101.{end}" for end in TARGETS[to].endings)


def test_files_of_no_dialect_are_refused():
    for files in ({}, {"FY_101.doc": ""}, {"FY_101.h": ""}):
        with pytest.raises(ParameterError, match="files of an exported block"):
            restore(files)


def test_help_and_documentation_name_every_dialect():
    (said,) = (option.help for option in typer.main.get_command(app).commands["export"].params if option.name == "to")
    table = (ROOT / "docs" / "export.md").read_text(encoding="utf-8")
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for name, dialect in TARGETS.items():
        assert name in said.replace(",", "").replace(".", "").split()
        assert f"| `{name}` | {dialect.title} | {dialect.proven} | {dialect.unproven} |" in table
        assert f"`{name}`" in readme
