"""What to do next after a result: command lines to paste, or a test in words where no command leads on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lostmotion.cli.options import RecordOptions
from lostmotion.cli.sources import Source, words_of
from lostmotion.printable import shell_line

if TYPE_CHECKING:
    from lostmotion.diagnose import Diagnosis
    from lostmotion.evaluate import Solution
    from lostmotion.identify import FitFacts, HammersteinFit

HOLDS = 40.0  # process times of a test: some 40 moves that settle
ROOM = 1.5  # times the widest lost motion that a test must cross to either side, at least
SPAN_SHARE = 0.01  # of the span of OP, 0 .. 100 or 0 .. 1 where it is not known: what is worth knowing
LONGEST = 3.0 * 86400.0  # s: for longer nobody gives up a loop, and a process that seems so slow is a drift
SPREAD = 0.3  # of a guess: what `design` takes by itself, and nothing that its check depends on
PLACE = "REASON"
# kinds of fit and verdicts for which `design` makes a test; for others it is described in words
DESIGNED, DESIGNED_VERDICTS = ("dead zone", "none"), ("dead zone", "cannot tell")


def command_lines(
    solution: Solution,
    file: Path,
    columns: RecordOptions,
    asked: dict[str, Any],
    linear_fit: Callable[[], FitFacts] | None = None,
) -> list[str]:
    """What to do after `solve` has come to a closed gate, most useful first.

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
        lines.append(line("solve", str(file), *_again(columns, asked, step.settings)))
    elif step.name == "check":
        lines.append(line("check", *words))
    elif step.name == "simulate" and solution.study is None and asked.get("kp") is None:
        lines.append(f"{line('solve', *words, *flags(asked))} --kp KP --ki KI")
    elif step.name in ("diagnose", "identify") and _telling(solution):
        lines += _test(solution, file, words, asked, linear_fit)
    if step.name == "diagnose":
        lines.append(line("diagnose", *words, *flags({name: asked.get(name) for name in ("loop_type", "integrating")})))
    if step.acceptable:
        others = {name: value for name, value in asked.items() if name != "accept"}
        lines.append(f'{line("solve", *words, *flags(others))} --accept "{PLACE}"')
    return lines


def after_diagnosis(file: Path, found: Diagnosis, *, columns: RecordOptions, known: Mapping[str, Any]) -> list[str]:
    """What to do after a diagnosis: the way to a block, the test or recording that tells, or nothing.

    Parameters
    ----------
    file, columns : Path and RecordOptions
        The record as it was read.
    found : Diagnosis
    known : mapping
        Options about the loop that were given.
    """
    from lostmotion.diagnose.sampling import sampling_advice
    from lostmotion.identify.actuators.kind import faults

    sized = [kind.name for kind in faults() if kind.size is not None]
    if found.verdict in sized and (found.severity != "low" or found.measured.swings):
        return [line("solve", *_words(file, columns), *flags(known))]
    if found.verdict != "cannot tell":
        return []
    return [sampling_advice(found) or in_words(found, found.fit)]


def after_fit(
    file: Path,
    fit: HammersteinFit,
    *,
    columns: RecordOptions,
    integrating: bool | None,
    gain: float | None,
    saved: Path | None,
) -> list[str]:
    """What to do after an identification: the way to a block, a test for a dead zone, the diagnosis, or nothing.

    Parameters
    ----------
    file, columns : Path and RecordOptions
        The record as it was read.
    fit : HammersteinFit
    integrating, gain
        As they were given.
    saved : Path or None
        File that the fit was written to.
    """
    from lostmotion.compensate.gate import closed

    facts, words = fit.facts, _words(file, columns)
    known = {"integrating": integrating}
    if facts.kind.size is None:
        return [] if facts.preferred == facts.kind.name else [line("diagnose", *words, *flags(known))]
    if closed(facts) is None:
        return [line("solve", *words, *flags(known | {"known_gain": gain}))]
    test = None if closed(facts, sized=False) is not None else _designed(fit, facts)
    if facts.kind.name == "dead zone" and test is not None:
        return _design(file, words, known | {"gain": gain}, test, saved)
    return [line("diagnose", *words, *flags(known))]


def in_words(found: Diagnosis, fit: HammersteinFit) -> str:
    """The test in manual that tells what this record does not."""
    from lostmotion.diagnose.manual_test import manual_test
    from lostmotion.diagnose.op_span import op_span

    span = op_span(found.record)
    tolerance = found.tolerance if found.excluded else SPAN_SHARE * (span.high - span.low)
    size = max(tolerance, _size_of(fit.facts))
    largest = max((one for one in found.excluded.values() if math.isfinite(one)), default=0.0)
    return manual_test(fit, size, found.measured.integrating, span.ends, tolerance, largest)


def _words(file: Path, columns: RecordOptions) -> list[str]:
    """The record as it is typed."""
    loop = file.loop if isinstance(file, Source) else None
    return [*words_of(file), *typed(columns if loop is None else replace(columns, loop=loop))]


def _again(columns: RecordOptions, asked: Mapping[str, Any], settings: Mapping[str, Any]) -> list[str]:
    """Options of `solve` with other settings; a span is one of the record."""
    options = {**asked, **settings}
    span = options.pop("span", columns.op_span)
    return [*typed(replace(columns, op_span=span)), *flags(options)]


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
    """Identify the record, and design the test that would tell; in words where `design` does not know the kind."""
    from lostmotion.compensate.gate import closed
    from lostmotion.diagnose.sampling import sampling_advice

    fit, found = solution.fit, solution.diagnosis
    if fit is None or found is None:
        return []
    if slow := sampling_advice(found):
        return [f"({slow})"]
    own = fit.kind.name == "dead zone" and closed(fit.facts, sized=False) is None
    known: dict[str, Any] = {"integrating": asked.get("integrating")}
    test = None
    if found.verdict not in DESIGNED_VERDICTS:
        pass
    elif own:
        known["gain"] = asked.get("known_gain")
        test = _designed(fit, fit.facts)
    elif fit.kind.name in DESIGNED:
        known["nonlinearity"] = "none"
        test = _designed(fit, fit.facts if linear_fit is None else linear_fit(), guess=True)
    return [f"({in_words(found, fit)})"] if test is None else _design(file, words, known, test)


def _design(
    file: Path, words: list[str], known: Mapping[str, Any], test: dict[str, Any], saved: Path | None = None
) -> list[str]:
    """Commands that save the fit, where it is not, and design the test from it."""
    out = str(saved or f"{file.stem}.fit.json")
    design = line("design", "--fit", out, *flags(test), "--out", f"{file.stem}.test.csv")
    return [design] if saved is not None else [line("identify", *words, *flags(known), "--out", out), design]


def _designed(fit: HammersteinFit, used: FitFacts, *, guess: bool = False) -> dict[str, Any] | None:
    """Options of a `design` that keeps to what the record shows, from its present OP and PV; None where it refuses.

    Parameters
    ----------
    fit : HammersteinFit
        Of the record.
    used : FitFacts
        What the printed `identify` finds.
    guess : bool
        Whether the break points are guessed.
    """
    from lostmotion.diagnose.manual_test import present, pv_limits

    low, high, ends = _room(fit.facts)
    op, pv = (float(f"{value:.4g}") for value in present(fit.data))
    options: dict[str, Any] = {"left": ends[0], "right": ends[1]} if guess else {}
    options |= {"op_limits": (min(low, op), max(high, op)), "pv_limits": pv_limits(fit.data)}
    options |= {"op_now": op, "pv_now": pv, "duration": _duration(used)}
    return options if _taken(used, dict(options)) else None


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
    try:
        pass_process(facts, None)
        if left is None:
            rough = known(facts, None, SPREAD)
        else:
            rough = known(Hammerstein(DeadZone(left, right), facts.linear, facts.model.offset), facts.noise, SPREAD)
        check(
            rough, loop="open", controller=None, sp_limits=None, rate_limit=None, shortest_hold=None,
            wanted=None, target="width", seed=0, **options,
        )  # fmt: skip
    except InputError:
        return False
    return True


def _size_of(facts: FitFacts) -> float:
    """Size that was fitted; 0 where the kind has none."""
    return facts.parameters[facts.kind.size] if facts.kind.size else 0.0


def _room(facts: FitFacts) -> tuple[float, float, tuple[float, float]]:
    """Limits of OP for a test, and a guess of break points in their middle."""
    low, high = facts.op_range
    from lostmotion.records.span import FRACTION, PERCENT

    span = facts.op_span or (PERCENT if high > 1.5 or low < 0.0 else FRACTION)
    middle, scale = 0.5 * (low + high), span[1] - span[0]
    half = max(0.5 * SPAN_SHARE * scale, 0.5 * _size_of(facts))
    reach = max(0.5 * (high - low), half + 2.0 * ROOM * half)
    rounded = [float(f"{value:.4g}") for value in (middle - reach, middle + reach, middle - half, middle + half)]
    return rounded[0], rounded[1], (rounded[2], rounded[3])


def typed(columns: RecordOptions) -> list[str]:
    """Options of the record as they were given."""
    given = {
        one.name: getattr(columns, one.name) for one in fields(columns) if getattr(columns, one.name) != one.default
    }
    return flags(given)


def flags(given: Mapping[str, Any]) -> list[str]:
    """Options of a command line, of those that were given."""
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


def line(*words: str) -> str:
    """A command to paste."""
    return f"lostmotion {shell_line(words)}"
