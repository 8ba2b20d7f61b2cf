"""A test design, and what data can achieve, as text."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

import numpy as np

from lostmotion.design import Achievable, TestDesign
from lostmotion.design.design_wording import in_words
from lostmotion.report.fit_text import WIDTH

CALLED = {"left": "left break point", "right": "right break point"}
MEANING = {
    "width": "right - left, in units of OP",
    "left": "break point, in units of OP",
    "right": "break point, in units of OP",
    "slope_ratio": "left_slope / right_slope",
}


def design_summary(design: TestDesign) -> str:
    """Report of a test design as plain text."""
    lines = [_fill(headline(design)), "=" * WIDTH, _fill(_answer(design))]
    lines += [_fill(f"ACCEPTED behind a closed gate: {said}.") for said in _accepted(design)]
    lines += [_fill("To relax: " + sentence) for sentence in design.advice]
    lines += ["", _table(design), "", _fill(_rival(design)), _fill(_moves(design)), _fill(_seen(design))]
    lines += [_fill(_assumed(design)), _fill(NEXT)]
    return "\n".join(lines)


NEXT = (
    "Then: write the signal to a file, run it, record OP and PV at the same sampling time, and give the "
    "record to identify. The figures hold if the actuator is a dead zone; identify tests that."
)


def _accepted(result: TestDesign | Achievable) -> list[str]:
    """What was accepted to get the model."""
    return [result.settings["accepted"]] if "accepted" in result.settings else []


def headline(design: TestDesign) -> str:
    """What the test is."""
    kind = "OP steps in open loop" if design.loop == "open" else "SP steps in closed loop"
    return f"Test design: {kind}, {in_words(design.duration)} ({len(design.signal)} samples of {design.dt:g} s)"


def _answer(design: TestDesign) -> str:
    expected = _expected(design)
    if design.wanted is None:
        return expected if design.reached else "NOT POSSIBLE within the limits. " + expected
    goal = ", ".join(f"{_called([name])} to {_pm(value)}" for name, value in design.wanted.items())
    share = f"{100 * design.reached_by:.0f} % of the plausible plants reach it. "
    if design.reached:
        return f"Wanted: {goal}. REACHED, in the shortest time found; {share}{expected}"
    return f"Wanted: {goal}. NOT REACHED within the limits; {share}{expected}"


def _expected(design: TestDesign) -> str:
    reach, median = design.expected[design.target], design.expected_typical[design.target]
    plants = f"{design.settings['plants']} plausible plants ({design.settings['roughness']})"
    name, worst = _called([design.target]), design.expected_worst[design.target]
    if np.isinf(reach) and np.isinf(median):
        return f"The {name} would still be unknown, if the model is right and for most of {plants}."
    return (
        f"Expected 95 % interval of the {name}: {_pm(reach)} if the model is right; {_pm(median)} in the median and "
        f"{_pm(worst)} at worst over {plants}."
    )


def _table(design: TestDesign) -> str:
    lines = [f"{'95 % +-':14}{'model':>10}{'median':>10}{'worst':>10}{'PRS':>10}   ", "-" * WIDTH]
    for name, meaning in MEANING.items():
        cells = [
            values.get(name, np.inf)
            for values in (design.expected, design.expected_typical, design.expected_worst, design.prs_expected)
        ]
        lines.append(f"{name:14}" + "".join(f"{_number(cell):>10}" for cell in cells) + f"   {meaning}")
    return "\n".join(lines)


def _rival(design: TestDesign) -> str:
    gain, best = design.gain_over_prs, design.gain_over_best_prs
    if not design.reached and not np.isfinite(design.expected[design.target]):
        return "PRS: " + ("cannot tell it either." if gain == 1.0 else "tells more here; use it, or relax the limits.")
    if np.isinf(gain):
        return "PRS: a pseudo-random staircase within these limits tells nothing about it."
    text = (
        f"PRS: a pseudo-random staircase of the same length, limits and shortest hold (median over seeds); its "
        f"interval of the {_called(design.goals)} is {gain:.2g} times as wide"
    )
    if best < 0.95 * gain:
        text += f", with its best hold ({design.best_prs_hold:g} s) {best:.2g} times"
    return text + "." + _one_sided(design)


def _one_sided(design: TestDesign) -> str:
    """A test for the width may know less about where the dead zone lies."""
    ends = ("left", "right")
    if list(design.goals) != ["width"] or all(design.expected[name] <= design.prs_expected[name] for name in ends):
        return ""
    return (
        " The break points one by one are not what this test is made for; where they matter more than the width, ask "
        'for them (target="break points", or wanted left and right).'
    )


def _called(names: Iterable[str]) -> str:
    return " and ".join(CALLED.get(name, name) for name in names)


def _moves(design: TestDesign) -> str:
    times, levels = np.array(design.steps).T
    holds = np.diff([*times, design.duration])
    return (
        f"{len(levels)} moves of {design.moved} between {levels.min():.4g} and {levels.max():.4g} from "
        f"{design.limits.start:.4g}, each level held {holds.min():.3g} to {holds.max():.3g} s (at least "
        f"{design.limits.hold * design.dt:.3g} s allowed)."
    )


def _seen(design: TestDesign) -> str:
    seen = design.prediction
    text = f"PV stays between {seen.pv_low.min():.4g} and {seen.pv_high.max():.4g}"
    if np.isfinite(design.limits.pv).any():
        text += f" (limits {design.limits.pv[0]:.4g} .. {design.limits.pv[1]:.4g})"
    if design.loop == "closed":
        text += f", OP between {seen.op_low.min():.4g} and {seen.op_high.max():.4g}"
        if np.isfinite(design.limits.op).any():
            text += f" (limits {design.limits.op[0]:.4g} .. {design.limits.op[1]:.4g})"
    noise = "its noise with three deviations" if design.loop == "open" else "with its noise"
    return text + f", in all plausible plants, {noise}; without other disturbances."


def _assumed(design: TestDesign) -> str:
    said = list(design.settings["assumed"])
    if not said:
        return f"Before the test the plant rests at OP = {design.op_now:.5g}."
    return "Assumed: " + "; ".join(said) + "."


def achievable_summary(answer: Achievable) -> str:
    """Report of what data can achieve as plain text."""
    left, inside, right = answer.beyond
    lines = [
        f"Best that {answer.samples} samples ({in_words(answer.duration)}) can give",
        "=" * WIDTH,
        *(_fill(f"ACCEPTED behind a closed gate: {said}.") for said in _accepted(answer)),
        _fill(answer.sentence),
        _fill(_sees(answer)),
        "",
        f"{'95 % +-':14}{'model':>10}{'best':>10}{'worst':>10}",
        "-" * WIDTH,
    ]
    for name, meaning in MEANING.items():
        cells = [values.get(name, np.inf) for values in (answer.expected, answer.expected_best, answer.expected_worst)]
        lines.append(f"{name:14}" + "".join(f"{_number(cell):>10}" for cell in cells) + f"   {meaning}")
    lines += [
        "",
        _fill(
            f"OP was left of the dead zone in {left}, inside in {inside}, right of it in {right} samples. Best and "
            f"worst over {answer.settings['plants']} plausible plants: {answer.settings['roughness']}."
        ),
        _fill(
            "Cramer-Rao bound with everything unknown: process, slopes, offset, initial state, noise model. A real "
            "record does worse where it drifts, is quantised or compressed."
        ),
    ]
    return "\n".join(lines)


def _sees(answer: Achievable) -> str:
    if answer.sees:
        return f"A dead zone as wide as the model's ({answer.width:.3g}) can be told from none."
    return (
        f"A dead zone as wide as the model's ({answer.width:.3g}) cannot be told from none: do not expect identify to "
        f"find it, ask for a test (lostmotion design)."
    )


def _pm(value: float) -> str:
    return "unknown" if not np.isfinite(value) else f"+-{value:.2g}"


def _number(value: float) -> str:
    return "unknown" if not np.isfinite(value) else f"{value:.3g}"


def _fill(text: str) -> str:
    return textwrap.fill(text, WIDTH, subsequent_indent="  ")
