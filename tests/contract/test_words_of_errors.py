"""Errors of the library name no option of a command; the command line puts options for settings."""

import ast
import re

import pytest

from tests.support import places

ROOT = places.ROOT / "src" / "lostmotion"
COMMANDS = ("cli", "live", "web")  # nothing in them is called from Python
FILES = sorted(path for path in ROOT.rglob("*.py") if path.relative_to(ROOT).parts[0] not in COMMANDS)
OPTION = re.compile(r"(?<![\w`-])--[a-z][a-z-]+")
WHOLE_COMMAND = re.compile(r"lostmotion [a-z-]+[^,;]*")  # a command that is named as a whole stays one


def texts(tree):
    """Texts that are no docstrings."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node


def docstrings(tree):
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list) and body and isinstance(body[0], ast.Expr):
            yield body[0].value


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_option_in_an_error(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    described = {id(node) for node in docstrings(tree)}
    reports = path.relative_to(ROOT).parts[0] == "report"  # they print whole commands, put together
    found = [
        f"{node.lineno}: {node.value}"
        for node in texts(tree)
        if id(node) not in described and OPTION.search(WHOLE_COMMAND.sub("", node.value))
    ]
    assert found == [] or reports


def raised(tree):
    """Texts in what is raised."""
    return [text for node in ast.walk(tree) if isinstance(node, ast.Raise) for text in texts(node)]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_no_error_sends_to_a_docstring(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    assert [node.value for node in raised(tree) if "docstring" in node.value] == []
