"""What benchmarks and examples import from the package is there: they run for hours, and seldom."""

import ast
from importlib import import_module

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


def test_imports_of_scripts():
    wanted = {(path.relative_to(ROOT).as_posix(), *pair) for path in SCRIPTS for pair in imported(path)}
    assert len(wanted) > len(SCRIPTS)
    assert sorted(one for one in wanted if not is_there(*one[1:])) == []
