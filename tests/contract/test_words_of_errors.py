"""Errors of the library name no option of a command; the command line puts options for settings."""

import ast
import re

from tests.support import places

ROOT = places.ROOT / "src" / "lostmotion"
COMMANDS = ("cli", "live", "web")  # nothing in them is called from Python
FILES = sorted(path for path in ROOT.rglob("*.py") if path.relative_to(ROOT).parts[0] not in COMMANDS)
TREES = {path: ast.parse(path.read_text(encoding="utf-8")) for path in FILES}
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


def test_no_option_in_an_error():
    found = []
    for path, tree in TREES.items():
        described = {id(node) for node in docstrings(tree)}
        reports = path.relative_to(ROOT).parts[0] == "report"  # they print whole commands, put together
        found += [
            f"{path}:{node.lineno}: {node.value}"
            for node in texts(tree)
            if not reports and id(node) not in described and OPTION.search(WHOLE_COMMAND.sub("", node.value))
        ]
    assert found == []


def raised(tree):
    """Texts in what is raised."""
    return [text for node in ast.walk(tree) if isinstance(node, ast.Raise) for text in texts(node)]


def test_no_error_sends_to_a_docstring():
    assert [node.value for tree in TREES.values() for node in raised(tree) if "docstring" in node.value] == []
