"""Command lines to paste where a gate is closed."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lostmotion.cli.options import RecordOptions

if TYPE_CHECKING:
    from lostmotion.evaluate import Solution
    from lostmotion.identify import FitFacts

HOLDS = 40.0  # process times of a test: some 40 moves that settle
ROOM = 1.5  # times the widest lost motion that a test must cross to either side, at least
SPAN_SHARE = 0.01  # of the range of OP 0 .. 100 or 0 .. 1: what is worth knowing
PLACE = "REASON"


def command_lines(solution: Solution, file: Path, columns: RecordOptions, asked: dict[str, Any]) -> list[str]:
    """What to type next, most useful first.

    Parameters
    ----------
    solution : Solution
        With a closed gate.
    file, columns : Path and RecordOptions
        The record as it was read.
    asked : dict
        Other options of `solve` that were given.
    """
    step = solution.closed
    assert step is not None  # noqa: S101  nothing to open otherwise
    words = [str(file), *typed(columns)]
    lines = []
    if step.settings:
        lines.append(_line("solve", str(file), *_again(columns, asked, step.settings)))
    elif step.name == "check":
        lines.append(_line("check", *words))
    elif step.name == "simulate" and solution.study is None and asked.get("kp") is None:
        lines.append(f"{_line('solve', *words, *_flags(asked))} --kp KP --ki KI")
    elif step.name in ("diagnose", "identify") and _telling(solution):
        lines += _test(solution, file, words)
    if step.name == "diagnose":
        lines.append(_line("diagnose", *words))
    if step.acceptable:
        lines.append(f'{_line("solve", *words, *_flags(asked))} --accept "{PLACE}"')
    return lines


def _again(columns: RecordOptions, asked: Mapping[str, Any], settings: Mapping[str, Any]) -> list[str]:
    """Options of `solve` with other settings; a span is one of the record."""
    options = {**asked, **settings}
    span = options.pop("span", columns.op_span)
    return [*typed(replace(columns, op_span=span)), *_flags(options)]


def _telling(solution: Solution) -> bool:
    """Whether a test would say more than this record."""
    return solution.diagnosis is not None and solution.diagnosis.verdict not in ("other oscillation", "saturation")


def _test(solution: Solution, file: Path, words: list[str]) -> list[str]:
    """Identify the record, and design the test that would tell."""
    fit, out = solution.fit, file.with_suffix(".fit.json").name
    if fit is None:
        return []
    facts = fit.facts
    own = facts.kind.name == "dead zone" and facts.preferred == "dead zone"
    low, high, guess = _room(facts)
    options: dict[str, Any] = {} if own else {"left": guess[0], "right": guess[1]}
    options |= {"op_limits": (low, high), "duration": float(f"{HOLDS * max(facts.linear.process_time, facts.dt):.2g}")}
    if facts.linear.integrates():
        options["pv_limits"] = (float(f"{fit.data.y.min():.4g}"), float(f"{fit.data.y.max():.4g}"))
    asked = () if own else ("--nonlinearity", "none")
    return [
        _line("identify", *words, *asked, "--out", out),
        _line("design", "--fit", out, *_flags(options), "--out", "test.csv"),
    ]


def _room(facts: FitFacts) -> tuple[float, float, tuple[float, float]]:
    """Limits of OP for a test, and a guess of break points in their middle."""
    low, high = facts.op_range
    middle, scale = 0.5 * (low + high), 100.0 if high > 1.5 or low < 0.0 else 1.0
    size = facts.kind.size
    half = max(0.5 * SPAN_SHARE * scale, 0.5 * facts.parameters[size] if size else 0.0)
    reach = max(0.5 * (high - low), half + 2.0 * ROOM * half)
    rounded = [float(f"{value:.4g}") for value in (middle - reach, middle + reach, middle - half, middle + half)]
    return rounded[0], rounded[1], (rounded[2], rounded[3])


def typed(columns: RecordOptions) -> list[str]:
    """Options of the record as they were given."""
    given = {
        one.name: getattr(columns, one.name) for one in fields(columns) if getattr(columns, one.name) != one.default
    }
    return _flags(given)


def _flags(given: dict[str, Any]) -> list[str]:
    words = []
    for name, value in given.items():
        if value is None or value is False:
            continue
        if isinstance(value, list):
            words += [word for one in value for word in (f"--{name.replace('_', '-')}", str(one))]
            continue
        values = value if isinstance(value, tuple) else (value,)
        shown = [] if value is True else [f"{one:g}" if isinstance(one, float) else str(one) for one in values]
        words += [f"--{name.replace('_', '-')}", *shown]
    return words


def _line(*words: str) -> str:
    return f"lostmotion {shlex.join(words)}"
