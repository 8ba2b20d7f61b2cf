"""Where messages are made in the source, and which of these places were passed: for the audit of the readers."""

from __future__ import annotations

import ast
import builtins
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from lostmotion import errors
from lostmotion.records import findings

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
def passed(monkeypatch: pytest.MonkeyPatch) -> Iterator[set[tuple[str, int]]]:
    """File and line of each place that makes a message from here on."""
    seen: set[tuple[str, int]] = set()

    def note(*_: Any, **__: Any) -> None:
        frame = sys._getframe(1)
        while frame is not None and frame.f_code.co_filename in (errors.__file__, __file__):
            frame = frame.f_back
        if frame is not None and Path(frame.f_code.co_filename).is_relative_to(PACKAGE):
            seen.add((str(Path(frame.f_code.co_filename).relative_to(PACKAGE)), frame.f_lineno))

    made = findings.Finding

    def finding(*parts: Any) -> findings.Finding:
        note()
        return made(*parts)

    def begun(self: BaseException, *parts: Any) -> None:
        note()
        super(errors.LostMotionError, self).__init__(*parts)

    with monkeypatch.context() as patch:
        patch.setattr(errors.LostMotionError, "__init__", begun)
        patch.setattr(findings, "Finding", finding)
        yield seen
