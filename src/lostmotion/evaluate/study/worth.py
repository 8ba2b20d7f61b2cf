"""Is compensation, retuning or maintenance worth it: thresholds and sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from lostmotion.compensate import CompensatorBlock
from lostmotion.evaluate.limit_cycle import LimitCycle
from lostmotion.evaluate.study.study_result import CYCLE_TOLERANCE, LoopCase, MistakeCase

WORTH = 0.05  # of the IAE: less is not worth a change
SURE = 2.0  # standard errors by which a gain must be above nothing
WORSE = 1.05  # IAE with over without from which on a wrong estimate does harm
MUCH_TRAVEL = 3.0  # times the travel without: the valve wears
MUCH_WORSE = 1.2  # the same where the estimate is off by 20 %, a trial of strength where the fit knows better
LITTLE_MORE, BETTER = 1.5, 0.9  # of the cycle and of the IAE without
SHARE_GROUP = "20 %"
CALM = 0.25  # of the limit cycle: below it ways are compared by the IAE
UNFELT = 0.005  # of the IAE: reports say "stays as it is" up to here
HALF = 0.5  # of the limit cycle: what counts as gone
HEADINGS = {
    "compensate": "COMPENSATION is worth it.",
    "retune": "RETUNING is worth it; {block}.",
    "compensate and retune": "COMPENSATION is worth it TOGETHER WITH RETUNING, not with the present controller.",
    "maintain": "MAINTENANCE is what helps: {block}, and tuning alone does not help.",
    "leave": "NOTHING is worth a change in this operation: the fault costs next to nothing.",
}


@dataclass(frozen=True)
class Decision:
    """Recommendation, whether the block helps and is safe with the present controller, why, and the block in brief."""

    word: str
    useful: bool
    safe: bool
    reasons: tuple[str, ...]
    brief: tuple[str, ...]

    def adding(self, said: str) -> Decision:
        """With one more sentence behind the heading."""
        reasons, brief = ((first, said, *others) for first, *others in (self.reasons, self.brief))
        return replace(self, reasons=reasons, brief=brief)


def harmful(mistakes: Sequence[MistakeCase]) -> list[MistakeCase]:
    """Plants on which the block does harm: a larger limit cycle, or a larger error than without it.

    With less error, a loop that cycles anyway may do so a little more widely without noise, and one that did not may do
    so where its valve travels little more.
    """
    return [case for case in mistakes if (case.larger_cycle and not _outweighed(case)) or case.ratio > _bearable(case)]


def _outweighed(case: MistakeCase) -> bool:
    little = case.compensated.amplitude <= LITTLE_MORE * case.without.amplitude or case.travel_ratio <= MUCH_TRAVEL
    return little and case.ratio < BETTER


def _bearable(case: MistakeCase) -> float:
    return MUCH_WORSE if case.group == SHARE_GROUP else WORSE


def decide(
    cases: Mapping[str, LoopCase],
    mistakes: Sequence[MistakeCase],
    retuned: Sequence[MistakeCase],
    block: CompensatorBlock,
    noise: float = 0.0,
) -> Decision:
    """Recommendation and the sentences behind it; `noise` is its deviation in PV."""
    now = cases["without"]
    floor = max((case.floor for case in mistakes), default=0.0)
    harm = {"with": harmful(mistakes), "with, retuned": harmful(retuned)}
    safe = {name: not harm[name] and not _swings_more(cases[name], now, floor) for name in harm}
    helps = {name: _helps(cases[name], now, noise) for name in cases}
    word = _word(cases, helps, safe)
    heading = HEADINGS[word].format(block=_why_no_block(helps, safe))
    if word == "compensate and retune" and helps["with"] and safe["with"]:
        heading = "COMPENSATION is worth it, and more so TOGETHER WITH RETUNING."
    sentences = [heading, _with(cases, "with", helps), _wrong(harm["with"], mistakes)]
    brief = [*sentences, _travel(cases, "compensate" if helps["with"] and safe["with"] else word)]
    both = cases["with, retuned"]
    if _other(both, now) and (word != "compensate" or both.ratio < cases["with"].ratio - WORTH):
        sentences += [_with(cases, "with, retuned", helps), _wrong(harm["with, retuned"], retuned)]
    sentences += [_retuning(cases, helps), _maintenance(cases, helps), _gain(cases, block), _travel(cases, word)]
    said = (tuple(text for text in texts if text) for texts in (sentences, brief))
    return Decision(word, helps["with"], safe["with"], *said)


def _word(cases: Mapping[str, LoopCase], helps: Mapping[str, bool], safe: Mapping[str, bool]) -> str:
    """The least change that brings what can be had, within WORTH of the IAE."""
    ways = {
        "compensate": helps["with"] and safe["with"],
        "retune": helps["retuned"],
        "compensate and retune": helps["with, retuned"] and safe["with, retuned"],
    }
    names = {"compensate": "with", "retune": "retuned", "compensate and retune": "with, retuned"}
    open_ways = [way for way, usable in ways.items() if usable]
    if not open_ways:
        return "maintain" if helps["no fault"] else "leave"
    rests = {way: cases[names[way]].cycle.amplitude for way in open_ways}
    least = min(rests.values())
    calm = [way for way in open_ways if rests[way] <= max(2.0 * least, CALM * cases["without"].cycle.amplitude)]
    best = min(cases[names[way]].ratio for way in calm)
    return next(way for way in calm if cases[names[way]].ratio <= best + WORTH)


def _why_no_block(helps: Mapping[str, bool], safe: Mapping[str, bool]) -> str:
    """Which of the two keeps the block out, with the present controller and with the retuned one."""
    words = {"with": "", "with, retuned": " with the retuned controller"}
    said = []
    for name, where in words.items():
        reasons = [text for text, holds in (("adds nothing", helps[name]), ("is not safe", safe[name])) if not holds]
        said.append((" and ".join(reasons) or "adds nothing to that", where))
    if said[0][0] == said[1][0]:
        return f"a block {said[0][0]}"
    return "a block " + ", and ".join(f"{text}{where}" for text, where in said)


def _helps(case: LoopCase, now: LoopCase, noise: float) -> bool:
    """Less error; or a limit cycle that stands out of the noise is gone, and the error no larger."""
    gained = 1.0 - case.ratio
    seen = now.cycle.amplitude > noise
    calmer = seen and case.cycle.amplitude < HALF * now.cycle.amplitude
    unhurt = case.ratio <= 1.0 + max(SURE * case.ratio_error, UNFELT)
    return (gained > WORTH and gained > SURE * case.ratio_error) or (calmer and unhurt)


def _swings_more(case: LoopCase, now: LoopCase, floor: float) -> bool:
    return case.cycle.amplitude > max(CYCLE_TOLERANCE * now.cycle.amplitude, floor)


def _other(case: LoopCase, now: LoopCase) -> bool:
    return (case.controller.kp, case.controller.ki) != (now.controller.kp, now.controller.ki)


def _with(cases: Mapping[str, LoopCase], name: str, helps: Mapping[str, bool]) -> str:
    case, now = cases[name], cases["without"]
    what = "The block" if name == "with" else f"The block and a retuned controller ({_gains(case)})"
    text = f"{what}: {_change(case)}{_cycle(now, case)}"
    best = 1.0 - cases["no fault"].ratio
    if name == "with" and helps[name] and best > WORTH:
        text += f"; that is {100.0 * (1.0 - case.ratio) / best:.0f} % of what a perfect inverse would gain"
    return text + "."


def _gains(case: LoopCase) -> str:
    return f"Kp {case.controller.kp:.3g}, Ki {case.controller.ki:.3g} 1/s"


def _cycle(now: LoopCase, case: LoopCase) -> str:
    if now.cycle.amplitude == 0.0 and case.cycle.amplitude == 0.0:
        return ", no limit cycle before or after"
    return f", limit cycle of PV {_size(now.cycle)} before, {_size(case.cycle)} after"


def _size(cycle: LimitCycle) -> str:
    return f"+-{cycle.amplitude:.3g}" if cycle.amplitude else "none"


def _change(case: LoopCase) -> str:
    percent, error = 100.0 * (case.ratio - 1.0), 100.0 * case.ratio_error
    if abs(percent) <= SURE * error or abs(percent) < 100.0 * UNFELT:
        return f"the error (IAE) stays as it is ({percent:+.1f} %)"
    if percent > 200.0:
        return f"the error (IAE) becomes {case.ratio:.3g} times as large"
    return f"the error (IAE) {'falls' if percent < 0 else 'rises'} by {abs(percent):.0f} %"


def _wrong(harm: Sequence[MistakeCase], mistakes: Sequence[MistakeCase]) -> str:
    """What the block does where the estimate is wrong."""
    if not mistakes:
        return ""
    worst = max(mistakes, key=lambda case: case.ratio)
    least = min(case.ratio for case in mistakes)
    between = f"{least:.2f} .. {worst.ratio:.2f} times the IAE without"
    if not harm:
        said = _wider([case for case in mistakes if case.larger_cycle])
        return (
            f"Should the estimate be wrong (by two standard errors, by 20 %, {len(mistakes)} plants in all): "
            f"{between}, {said} without the block."
        )
    text = f"SHOULD THE ESTIMATE BE WRONG it does harm on {len(harm)} of {len(mistakes)} plants: {between}"
    cycles = [case for case in harm if case.larger_cycle]
    if cycles:
        most = max(cycles, key=lambda case: case.compensated.amplitude - case.without.amplitude)
        text += (
            f"; on {len(cycles)} a larger limit cycle, at most {_size(most.compensated)} in PV against "
            f"{_size(most.without)} ({most.group}: {most.what})"
        )
    return text + f"; worst error: {worst.group}, {worst.what}."


def _wider(larger: Sequence[MistakeCase]) -> str:
    """Of limit cycles that are outweighed by less error."""
    if not larger:
        return "on none a larger limit cycle than"
    new = [case for case in larger if not case.without.amplitude]
    if new:
        most = max(new, key=lambda case: case.compensated.amplitude)
        return f"on {len(new)} a limit cycle, {_size(most.compensated)} in PV at most, that is not there"
    most_times = max(case.compensated.amplitude / case.without.amplitude for case in larger)
    return f"on {len(larger)} a limit cycle up to {most_times:.1f} times as large as"


def _retuning(cases: Mapping[str, LoopCase], helps: Mapping[str, bool]) -> str:
    case, now = cases["retuned"], cases["without"]
    if not _other(case, now):
        return "Retuning alone: none of the settings tried (SIMC, 1 to 8 dead times) does better than the present ones."
    said = "" if helps["retuned"] else "not worth it, "
    return f"Retuning alone ({_gains(case)}): {said}{_change(case)}{_cycle(now, case)}."


def _maintenance(cases: Mapping[str, LoopCase], helps: Mapping[str, bool]) -> str:
    case = cases["no fault"]
    said = "" if helps["no fault"] else "would not be felt in this operation, "
    if case.ratio > WORSE:
        said = "not with these settings, "
    return f"Maintenance (no fault, present controller): {said}{_change(case)}{_cycle(cases['without'], case)}."


def _gain(cases: Mapping[str, LoopCase], block: CompensatorBlock) -> str:
    """What the block, or a mended valve, does to the gain of the loop."""
    text = ""
    slopes = [block.settings.get(f"{side}_slope", 1.0) for side in ("left", "right")]
    if not 0.95 < slopes[1] < 1.05:  # 1 by convention where the gain is not known
        text = (
            f"The block divides by the slopes {slopes[0]:.3g} and {slopes[1]:.3g} of the valve, and so does what is "
            "said of maintenance; a mended valve keeps them, so its controller needs gains smaller by as much."
        )
    if cases["no fault"].cycle.amplitude > 0.0:
        text += (
            " BEWARE: without the fault the loop is unstable with the present controller; the lost motion has been "
            "holding its gain down. Retune before compensation or maintenance."
        )
    return text.strip()


def _travel(cases: Mapping[str, LoopCase], word: str) -> str:
    name = {"compensate": "with", "retune": "retuned", "compensate and retune": "with, retuned"}.get(word)
    if name is None or not cases["without"].travel > 0.0:
        return ""
    times = cases[name].travel / cases["without"].travel
    return f"The price is wear: the command travels {times:.1f} times as far as now." if times > MUCH_TRAVEL else ""
