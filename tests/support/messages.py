"""Where messages are made in the source, and which of these places were passed: for the audit of the readers."""

from __future__ import annotations

import ast
import builtins
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from coverage import Coverage

from lostmotion import errors

PACKAGE = Path(errors.__file__).parent


class Place(NamedTuple):
    """Call that makes a message: file in the package, first and last line, and what it begins with."""

    file: str
    first: int
    last: int
    text: str


def places_in(file: str) -> Iterator[Place]:
    """Calls of ``SomeError(..)``, ``SomeError.expected(..)``, ``SomeError.missing(..)`` and ``Finding(..)``."""
    for node in ast.walk(ast.parse((PACKAGE / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and _makes_a_message(ast.unparse(node.func)):
            first = node.args[1 if ast.unparse(node.func) == "Finding" else 0] if node.args else node
            yield Place(file, node.lineno, node.end_lineno or node.lineno, ast.unparse(first)[:90])


def _makes_a_message(called: str) -> bool:
    owner, _, method = called.partition(".")
    ours = owner.endswith("Error") and not hasattr(builtins, owner)
    return called == "Finding" or (ours and method in ("", "expected", "missing"))


def refusals_in(file: str) -> Iterator[re.Pattern[str]]:
    """Returned texts that begin with "expected", as patterns."""
    for node in ast.walk(ast.parse((PACKAGE / file).read_text(encoding="utf-8"))):
        if isinstance(node, ast.Return) and isinstance(node.value, ast.JoinedStr):
            parts = [re.escape(part.value) if isinstance(part, ast.Constant) else ".*" for part in node.value.values]
            if parts[0].startswith("expected"):
                yield re.compile("".join(parts))


@contextmanager
def ran() -> Iterator[Callable[[], dict[str, set[int]]]]:
    """Gives, at the end, the lines of each file of the package that were run."""
    folders = [str(PACKAGE / name / "*") for name in ("files", "records")]
    watched = Coverage(data_file=None, include=folders, config_file=False, messages=False)
    watched.start()

    def lines() -> dict[str, set[int]]:
        data = watched.get_data()
        return {str(Path(file).relative_to(PACKAGE)): set(data.lines(file) or ()) for file in data.measured_files()}

    try:
        yield lines
    finally:
        watched.stop()
