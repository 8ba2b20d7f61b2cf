"""Nobody should have to scroll: sizes of files, functions and parameter lists."""

import ast

from tests.support import places

ROOT = places.ROOT / "src" / "lostmotion"
LONGEST_FILE, LONGEST_FUNCTION, MOST_PARAMETERS = 350, 60, 12
# all settings of a design or a study, and the columns of a table, are keywords of one public function;
# kernels have one loop over all filters
WIDE = {"audit", "check", "compensation_study", "design", "identify", "solve"}
LONG = {"kernels/recursive_ml/advance.py:advance"}


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


def test_sizes():
    large = []
    for path in sorted(ROOT.rglob("*.py")):
        here = path.relative_to(ROOT)
        long = len(path.read_text(encoding="utf-8").splitlines())
        large += [f"{here}: {long} lines"] if long > LONGEST_FILE else []
        for function in functions(path):
            place = f"{here.as_posix()}:{function.name}"
            large += [f"{place}: {lines(function)} lines"] if lines(function) > LONGEST_FUNCTION else []
            wide = parameters(function) > MOST_PARAMETERS and here.parts[0] not in ("kernels", "cli")
            large += [f"{place}: {parameters(function)} parameters"] if wide and function.name not in WIDE else []
    assert [one for one in large if one.split(": ")[0] not in LONG] == []
