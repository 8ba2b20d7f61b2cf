"""What is documented exists, and what exists is documented."""

import re

import typer

from lostmotion.cli import app
from tests.support.places import ROOT

README = (ROOT / "README.md").read_text(encoding="utf-8")
COMMANDS = sorted(typer.main.get_command(app).commands)


def test_every_command_is_in_the_readme():
    for command in COMMANDS:
        assert f"lostmotion {command}" in README


def test_every_documented_command_exists():
    for command in re.findall(r"^lostmotion ([\w-]+)", README, flags=re.MULTILINE):
        assert command in COMMANDS


def test_links_lead_somewhere():
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]
    links = [(page, link) for page in pages for link in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8"))]
    assert links
    assert [(page.name, link) for page, link in links if not (page.parent / link).exists()] == []


def test_every_module_says_what_it_is_for():
    for path in (ROOT / "src").rglob("*.py"):
        assert path.read_text(encoding="utf-8").startswith('"""'), path


def test_equation_page_names_what_exists():
    import lostmotion as lm

    text = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
    for name in re.findall(r"`lm\.(\w+)", text):
        assert hasattr(lm, name), name
