"""What is documented exists, and what exists is documented."""

import re

import pytest
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


@pytest.mark.parametrize(
    "page",
    ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", *(str(path.relative_to(ROOT)) for path in ROOT.glob("docs/*.md"))],
)
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#]+)\)", text):
        assert ((ROOT / page).parent / target).exists(), target


def test_every_module_says_what_it_is_for():
    for path in (ROOT / "src").rglob("*.py"):
        assert path.read_text(encoding="utf-8").startswith('"""'), path


def test_equation_page_names_what_exists():
    import lostmotion as lm

    text = (ROOT / "docs" / "equations.md").read_text(encoding="utf-8")
    for name in re.findall(r"`lm\.(\w+)", text):
        assert hasattr(lm, name), name
