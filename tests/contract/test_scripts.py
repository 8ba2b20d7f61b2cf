"""What benchmarks and examples import from the package is there: they run for hours, and seldom."""

import ast
from importlib import import_module

import pytest

from tests.support.places import ROOT

SCRIPTS = sorted([*(ROOT / "benchmarks").rglob("*.py"), *(ROOT / "examples").rglob("*.py")])


def imported(path):
    """Pairs of module and name, of ``from lostmotion.x import y``."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "lostmotion":
            yield from ((node.module, alias.name) for alias in node.names)


def is_there(module, name):
    try:
        return hasattr(import_module(module), name) or bool(import_module(f"{module}.{name}"))
    except ImportError:
        return False


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_of_a_script(path):
    assert [pair for pair in imported(path) if not is_there(*pair)] == []
