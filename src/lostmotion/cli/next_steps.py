"""Command lines to paste where a gate is closed."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lostmotion.cli.options import RecordOptions
from lostmotion.records.span import FRACTION, PERCENT

if TYPE_CHECKING:
    from lostmotion.arrays import FloatArray
    from lostmotion.evaluate import Solution
    from lostmotion.identify import FitFacts

HOLDS = 40.0  # process times of a test: some 40 moves that settle
ROOM = 1.5  # times the widest lost motion that a test must cross to either side, at least
SPAN_SHARE = 0.01  # of the span of OP, 0 .. 100 or 0 .. 1 where it is not known: what is worth knowing
LONGEST = 3.0 * 86400.0  # s: for longer nobody gives up a loop, and a process that seems so slow is a drift
SPREAD = 0.3  # of a guess: what `design` takes by itself, and nothing that its check depends on
PLACE = "REASON"


def command_lines(
    solution: Solution,
    file: Path,
    columns: RecordOptions,
    asked: dict[str, Any],
    linear_fit: Callable[[], FitFacts] | None = None,
) -> list[str]:
    """What to type next, most useful first.

    Parameters
    ----------
    solution : Solution
        With a closed gate.
    file, columns : Path and RecordOptions
        The record as it was read.
    asked : dict
        Other options of `solve` that were given.
    linear_fit : callable, optional
        Gives the fit of the record without a fault; None: the one that there is stands for it.
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
        lines += _test(solution, file, words, asked, linear_fit)
    if step.name == "diagnose":
        known = {name: asked.get(name) for name in ("loop_type", "integrating")}
        lines.append(_line("diagnose", *words, *_flags(known)))
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


def _test(
    solution: Solution,
    file: Path,
    words: list[str],
    asked: Mapping[str, Any],
    linear_fit: Callable[[], FitFacts] | None,
) -> list[str]:
    """Identify the record, and design the test that would tell; in words where no process is known to design it for."""
    from lostmotion.compensate.gate import closed

    fit, out = solution.fit, file.with_suffix(".fit.json").name
    if fit is None:
        return []
    facts = fit.facts
    own = facts.kind.name == "dead zone" and closed(facts, sized=False) is None
    low, high, guess = _room(facts)
    options: dict[str, Any] = {} if own else {"left": guess[0], "right": guess[1]}
    used = facts if own or linear_fit is None else linear_fit()  # what the printed `identify` is going to find
    options |= {"op_limits": (low, high), "duration": _duration(used)}
    if used.linear.integrates():
        options["pv_limits"] = _pv_limits(fit.data.y)
    if not _taken(used, dict(options)):
        return [_by_hand(used, low, high)]
    known = {"integrating": asked.get("integrating"), "gain": asked.get("known_gain") if own else None}
    kind = () if own else ("--nonlinearity", "none")
    return [
        _line("identify", *words, *kind, *_flags(known), "--out", out),
        _line("design", "--fit", out, *_flags(options), "--out", "test.csv"),
    ]


def _pv_limits(pv: FloatArray) -> tuple[float, float]:
    """The range of the record and a little more: PV at rest may lie at its edge."""
    low, high = float(pv.min()), float(pv.max())
    room = 0.05 * (high - low)
    return float(f"{low - room:.4g}"), float(f"{high + room:.4g}")


def _duration(facts: FitFacts) -> float:
    """Seconds of a test that settles often enough, and that `design` takes."""
    from lostmotion.design.request import MOST_SAMPLES, shortest_duration

    wished = min(HOLDS * max(facts.linear.process_time, facts.dt), MOST_SAMPLES * facts.dt)
    least = shortest_duration(facts.linear)
    rounded = float(f"{max(wished, least):.2g}")
    return rounded if rounded >= least else float(f"{1.05 * least:.2g}")


def _taken(facts: FitFacts, options: dict[str, Any]) -> bool:
    """Whether `design` takes these options, by its own check, and the test is one that an operator allows."""
    from lostmotion.compensate.gate import pass_process
    from lostmotion.design.prior import known
    from lostmotion.design.request import check
    from lostmotion.errors import InputError
    from lostmotion.models import DeadZone, Hammerstein

    if options["duration"] > LONGEST:
        return False
    left, right = options.pop("left", None), options.pop("right", None)
    limits = {"pv_limits": None} | options
    try:
        pass_process(facts, None)
        if left is None:
            rough = known(facts, None, SPREAD)
        else:
            rough = known(Hammerstein(DeadZone(left, right), facts.linear, facts.model.offset), facts.noise, SPREAD)
        check(
            rough, loop="open", controller=None, sp_limits=None, op_now=None, rate_limit=None, shortest_hold=None,
            wanted=None, target="width", seed=0, **limits,
        )  # fmt: skip
    except InputError:
        return False
    return True


def _by_hand(facts: FitFacts, low: float, high: float) -> str:
    """The test that needs no model."""
    from lostmotion.design.request import FEWEST_HOLDS, FEWEST_SAMPLES

    least = FEWEST_SAMPLES / FEWEST_HOLDS * facts.dt
    return (
        f"(no test can be designed from what this record says of the process; by hand: with the controller in manual, "
        f"step OP between {low:g} and {high:g}, {FEWEST_HOLDS} moves up and down, hold each until PV has settled, for "
        f"{least:.3g} s at least, and solve the record of that)"
    )


def _room(facts: FitFacts) -> tuple[float, float, tuple[float, float]]:
    """Limits of OP for a test, and a guess of break points in their middle."""
    low, high = facts.op_range
    span = facts.op_span or (PERCENT if high > 1.5 or low < 0.0 else FRACTION)
    middle, scale = 0.5 * (low + high), span[1] - span[0]
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
        if name == "integrating" and value is False:
            words.append("--self-regulating")
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
