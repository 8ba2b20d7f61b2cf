"""Nobody should have to scroll: sizes of files, functions and parameter lists."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2] / "src" / "lostmotion"
FILES = sorted(ROOT.rglob("*.py"))
LONGEST_FILE, LONGEST_FUNCTION, MOST_PARAMETERS = 350, 60, 12
# all settings of a design or a study are keywords of one public function; kernels have one loop over all filters
WIDE = {"design", "compensation_study", "check"}
LONG = {"advance"}


def functions(path):
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)]


def lines(function):
    """Without the docstring."""
    first = function.body[0]
    text = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and isinstance(first.value.value, str)
    return function.end_lineno - function.lineno + 1 - (first.end_lineno - first.lineno + 1 if text else 0)


def parameters(function):
    given = function.args
    return len(given.posonlyargs) + len(given.args) + len(given.kwonlyargs)


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_sizes(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= LONGEST_FILE
    room = path.relative_to(ROOT).parts[0]
    for function in functions(path):
        assert lines(function) <= LONGEST_FUNCTION or (function.name in LONG and room == "kernels"), function.name
        narrow = parameters(function) <= MOST_PARAMETERS
        assert narrow or room in ("kernels", "cli") or function.name in WIDE, function.name
