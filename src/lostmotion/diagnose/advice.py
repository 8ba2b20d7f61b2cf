"""What to do about a verdict, in words."""

from __future__ import annotations

from lostmotion.identify.actuators.kind import NO_FAULT, kind_of

BLOCKS = ("ompensat", "knocker")  # words of advice that mean a block in front of the valve
STUDY = (
    "Before any compensation run `lostmotion simulate` on this record: only where the simulated loop gets better, and "
    "stays safe should the estimate be wrong, is a block worth it; it is not advised before."
)


def advise(verdict: str, kind: str, severity: str, integrating: bool, swings: bool = False) -> tuple[str, ...]:
    """Sentences for the engineer, most important first."""
    if verdict == NO_FAULT:
        return ("Nothing to do for the actuator.",)
    if verdict == "cannot tell":
        return (
            "Make a test: with the controller in manual, step OP up, back, down and back, several times, by more than "
            "the lost motion that matters. Do not wait for a level to settle.",
        )
    if verdict == "other oscillation":
        return (_OTHER[kind],)
    words = kind_of(verdict).words
    first = words.advice
    if severity == "low" and not swings:
        first = ("It is within the 1 % of span that is recommended for control valves: watch it, do not mend it.",)
    return _studied_first((*first, *words.advice_for_levels) if integrating else first)


def _studied_first(sentences: tuple[str, ...]) -> tuple[str, ...]:
    """With the study, where a sentence speaks of a block."""
    if not any(word in sentence for sentence in sentences for word in BLOCKS):
        return sentences
    return (*sentences, STUDY)


_OTHER = {
    "tuning": "Retune: the loop itself is near its limit of stability. Lower the gain, or the integral action.",
    "disturbance": "Look upstream: the loop follows an oscillation that comes from elsewhere. Compare the periods of "
    "its neighbours.",
    "set point": "Nothing to do in this loop. Look at what moves SP: an operator, or the outer loop of a cascade.",
    "sensor": "Look at the measurement: it moves in steps that are large beside the oscillation.",
    "unknown": "Put the controller in manual for a few periods: if PV goes on swinging, look upstream; if it calms "
    "down, retune.",
}
