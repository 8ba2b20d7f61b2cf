"""The whole way as text: a line for each step, and the outcome first."""

from __future__ import annotations

from lostmotion.evaluate.solution import Solution, Step
from lostmotion.report.fit_text import fill

WORDS = {
    "block": "A BLOCK came out: every gate was open.",
    "nothing wrong": "NOTHING WRONG with the actuator that this record would show: no block is needed.",
}


def solution_summary(solution: Solution) -> str:
    """Report of a solution as plain text."""
    parts = [fill(outcome(solution)), *(fill(_line(step)) for step in solution.steps)]
    if solution.closed is not None:
        parts.append(fill(f"What opens it: {solution.closed.remedy.rstrip('.')}."))
    return "\n".join(parts)


def outcome(solution: Solution) -> str:
    """How the way ended, in one sentence."""
    if solution.closed is not None:
        return f"NO BLOCK: the gate at step {solution.closed.name!r} is closed."
    if solution.block is not None and solution.block.accepted:
        return f"A BLOCK came out, ACCEPTED behind a closed gate: {solution.block.accepted}."
    return WORDS[solution.outcome]


def _line(step: Step) -> str:
    return f"{step.name:9} {'open  ' if step.passed else 'CLOSED'}  {step.said}"
