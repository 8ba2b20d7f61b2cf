"""Compiled code that takes the address of an array keeps the array: what is freed may be anybody's."""

import ast
import json
import os
import platform
import sys
from subprocess import run

import pytest
from numba import config

from tests.support.places import ROOT

KERNELS = sorted((ROOT / "src" / "lostmotion" / "kernels").rglob("*.py"))


def called(node, name):
    return isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == name


def names_in(node):
    return {one.id for one in ast.walk(node) if isinstance(one, ast.Name)}


def base(node):
    """The array of which a view is: `x` of `x[0].reshape(-1)`."""
    while not isinstance(node, ast.Name):
        node = node.func if isinstance(node, ast.Call) else node.value
    return node.id


def kept_by_callers(function):
    """Arrays that outlive a call: what is handed to a function, unless its lines are copied into the caller's."""
    inlined = any(
        keyword.arg == "inline" for one in function.decorator_list for keyword in getattr(one, "keywords", ())
    )
    assigned = {one.id for one in ast.walk(function) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    return set() if inlined else {one.arg for one in function.args.args} - assigned


def freed_early(function):
    """Arrays whose address is used but that are not kept to the end of the block in which it was taken."""
    blocks = [part for one in ast.walk(function) for part in (getattr(one, "body", None),) if isinstance(part, list)]
    found = set()
    for block in blocks:
        taken = {
            base(one.args[0])
            for line in block
            if not hasattr(line, "body")
            for one in ast.walk(line)
            if called(one, "address")
        }
        last = [None, *(line for line in block if not isinstance(line, ast.Return))][-1]
        kept = names_in(last) if isinstance(last, ast.Expr) and called(last.value, "alive") else set()
        found |= taken - kept
    return found - kept_by_callers(function)


def functions():
    for path in KERNELS:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                yield path, node


def test_arrays_outlive_their_addresses():
    faults = {f"{path.name}:{node.name}": freed for path, node in functions() if (freed := freed_early(node))}
    assert not faults
    assert sum(called(one, "address") for _, node in functions() for one in ast.walk(node)) > 40


@pytest.mark.parametrize(
    ("code", "freed"),
    [
        ("def f(x):\n to = address(x)\n store(to, 0, 1)", set()),
        ("def f():\n x = empty(3)\n store(address(x), 0, 1)", {"x"}),
        ("def f(y):\n if y:\n  x = empty(3)\n  g(address(x[0].reshape(-1)))\n  alive(x)\n return y", set()),
        ("@njit(inline='always')\ndef f(x):\n to = address(x)\n return to[0]", {"x"}),
        ("def f(x):\n x = x.copy()\n to = address(x)\n return to[0]", {"x"}),
    ],
)
def test_early_freed_arrays_are_seen(code, freed):
    assert freed_early(ast.parse(code).body[0]) == freed


@pytest.mark.long
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="fills freed memory by a setting of glibc")
@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="of compiled code")
def test_results_do_not_depend_on_what_lies_in_freed_or_new_memory():
    """Freed memory is filled with a byte and new memory with its complement: 0.0, NaN and numbers such as 1e103."""

    def found(byte):
        words = [sys.executable, "-m", "tests.support.results_of_kernels"]
        done = run(
            words, cwd=ROOT, env={**os.environ, "MALLOC_PERTURB_": byte}, timeout=500, check=True, capture_output=True
        )
        return json.loads(done.stdout)

    first = found("0")
    assert len(first) > 10
    assert found("85") == first
    assert found("255") == first
