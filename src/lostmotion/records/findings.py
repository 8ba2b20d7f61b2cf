"""Rules: facts about a record -> findings with a remedy. One function a subject."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.records import limits
from lostmotion.records.averaged import steps_of
from lostmotion.records.loop_facts import LoopFacts
from lostmotion.records.report import Finding
from lostmotion.records.sampling import Sampling
from lostmotion.records.signal_facts import SignalFacts
from lostmotion.records.span import Span, beyond, of_other_units


def about_sampling(sampling: Sampling) -> Iterator[Finding]:
    """Too short, missing rows, gaps."""
    piece = sampling.longest_piece
    where = "" if piece == sampling.samples else " in the longest unbroken stretch"
    if piece < limits.SHORTEST:
        yield Finding(
            "error",
            f"Only {piece} samples{where}.",
            f"A model needs at least {limits.SHORTEST}.",
            "Use a longer record or a shorter sampling time.",
        )
    elif piece < limits.SHORT:
        yield Finding(
            "warning",
            f"Only {piece} samples{where}.",
            f"Below {limits.SHORT} the interval of a dead zone is wide.",
            "Use a longer record.",
        )
    if sampling.missing:
        share = f"{100 * sampling.missing_share:.2g} %"
        yield Finding(
            "warning" if sampling.missing_share > limits.MISSING_SHARE else "info",
            f"{sampling.missing} of {sampling.samples} rows miss OP or PV ({share}).",
            f"Runs of at most {limits.BRIDGE_ROWS} are bridged, longer ones cut the record into pieces.",
            "Export the raw values again if you can.",
        )
    if sampling.gaps:
        yield Finding(
            "info",
            f"Time is missing in {sampling.gaps} place{'s' if sampling.gaps > 1 else ''}.",
            "The model is not carried across a gap.",
            "",
        )


def about_signal(facts: SignalFacts | None, name: str, dt: float) -> Iterator[Finding]:
    """Missing or constant signal, else its stretches, resolution and spikes."""
    if facts is None:
        yield Finding("error", f"Every sample of {name} is missing.", "", "Check the column and its export.")
    elif facts.constant:
        why = "Nothing moved the actuator" if name == "OP" else "Nothing was measured"
        yield Finding(
            "error",
            f"{name} is constant ({facts.low:g}).",
            f"{why}, so lost motion cannot be identified.",
            "Use a record in automatic with set-point moves, or a test.",
        )
    else:
        yield from _flat(facts, dt)
        yield from _straight(facts)
        yield from _resolution(facts)
        yield from _spikes(facts)


def _flat(facts: SignalFacts, dt: float) -> Iterator[Finding]:
    length = f"{facts.longest_flat} samples ({facts.longest_flat * dt:g} s)"
    if facts.flat_share > limits.FLAT_SHARE and facts.name == "PV":
        yield Finding(
            "warning",
            f"PV stands still in {100 * facts.flat_share:.0f} % of the record, at longest for {length}.",
            "A historian's exception limit, a sensor that sticks, or lost motion itself looks like this.",
            "Export raw values, or lower the compression limits of the tag.",
        )
    elif facts.longest_flat >= limits.FLAT_RUN:
        yield Finding("info", f"{facts.name} stands still for {length} at longest.", "", "")


def _straight(facts: SignalFacts) -> Iterator[Finding]:
    if facts.linear_share > limits.LINEAR_SHARE:
        yield Finding(
            "warning" if facts.name == "PV" else "info",
            f"{facts.name} runs on straight lines in {100 * facts.linear_share:.0f} % of the record.",
            "Values interpolated between stored points look like this; they hide stick and slip.",
            "Export raw values instead of interpolated ones, with compression off.",
        )


def _resolution(facts: SignalFacts) -> Iterator[Finding]:
    coarse = facts.amplitude > 0 and facts.step > limits.COARSE_STEP * facts.amplitude
    if facts.levels <= limits.FEW_LEVELS or coarse:
        in_steps = facts.name == "OP" and facts.flat_share > limits.FLAT_SHARE
        yield Finding(
            "info" if in_steps else "warning",
            f"{facts.name} takes only {facts.levels} levels, {facts.step:g} or more apart.",
            "What is smaller than a step cannot be seen.",
            "Export with more decimals, or widen the test.",
        )


def _spikes(facts: SignalFacts) -> Iterator[Finding]:
    count = len(facts.spikes)
    if count:
        rows = ", ".join(str(row + 1) for row in facts.spikes[:5]) + (".." if count > 5 else "")
        many = count > 1 and count > limits.MANY_OUTLIERS * max(facts.changes, 1)
        yield Finding(
            "warning" if many else "info",
            f"{facts.name} has {count} spike{'s' if count > 1 else ''} (row {rows}).",
            "Single wild samples bend a least-squares fit.",
            "Replace them by empty cells if they are not real.",
        )


def about_span(name: str, values: FloatArray, span: Span | None) -> Iterator[Finding]:
    """Values outside their span: it may be that of other units."""
    share = float(np.mean(beyond(values, span)))
    if span is None or share <= limits.OUTSIDE_SHARE:
        return
    other = of_other_units(values, span)
    yield Finding(
        "warning",
        f"{name} is outside of its span, {span[0]:g} to {span[1]:g}, in {100 * share:.0f} % of the record.",
        "The span is one of other units: nothing can be told in % of it."
        if other
        else "Beyond a limit nothing moves; or the span is one of other units, and sizes in % of it are wrong.",
        f"Leave the span out, or give it in the units of {name}, which runs from {np.nanmin(values):.4g} to "
        f"{np.nanmax(values):.4g}.",
    )


def about_means(sp: FloatArray | None) -> Iterator[Finding]:
    """Rows that are no samples, by the steps of SP."""
    steps = steps_of(sp)
    if steps.averaged:
        yield Finding(
            "warning",
            f"SP goes through an odd value between in {steps.through} of its {steps.count} steps.",
            "The rows are means over several scans, or interpolated: over four scans and more the width comes out too "
            "small, by 0.5 to 0.9 standard errors.",
            "Export samples, one of a scan.",
        )


def about_loop(loop: LoopFacts, op: SignalFacts, dt: float) -> Iterator[Finding]:
    """Refresh of the record, excitation and saturation of OP; nothing where OP is constant."""
    if op.constant:
        return
    if loop.refresh_rows > limits.REFRESH_ROWS and op.levels > limits.FEW_LEVELS:
        yield Finding(
            "warning",
            f"OP and PV change only every {loop.refresh_rows:.1f} rows ({loop.refresh_rows * dt:.3g} s).",
            "The record is faster than the scan behind it, so delays look longer than they are.",
            "Export at the scan time of the controller.",
        )
    elif loop.longest_frozen >= limits.FROZEN_RUN and op.flat_share <= limits.FLAT_SHARE:
        yield Finding(
            "warning",
            f"OP and PV both stand still for {loop.longest_frozen} samples ({loop.longest_frozen * dt:g} s).",
            "The recording, not the loop, may have stopped; a frozen stretch looks like stiction.",
            "Empty the cells of such stretches, or use another part of the record.",
        )
    yield from _excitation(loop, op)
    yield from _saturation(loop)


def _excitation(loop: LoopFacts, op: SignalFacts) -> Iterator[Finding]:
    share = op.amplitude_of_span
    if share is not None and share < limits.SMALL_AMPLITUDE:
        yield Finding(
            "warning",
            f"OP moved over {100 * share:.2g} % of span only (5-95 %).",
            f"A dead zone of {100 * limits.SMALL_AMPLITUDE:g} % cannot be seen.",
            f"Use a longer record or a test of at least {200 * limits.SMALL_AMPLITUDE:g} %; where the span is one of "
            f"other units, give one in those of OP, which runs from {op.low:.4g} to {op.high:.4g}.",
        )
    if loop.op_reversals < limits.FEW_REVERSALS:
        yield Finding(
            "warning",
            f"OP turned round only {loop.op_reversals} times by more than a tenth of its amplitude.",
            "Lost motion shows only when OP turns round.",
            "Use a longer record, or a test that moves OP up and down several times.",
        )


def _saturation(loop: LoopFacts) -> Iterator[Finding]:
    for share, limit in ((loop.saturated_low, "lower"), (loop.saturated_high, "upper")):
        if share > limits.SATURATED_SHARE:
            yield Finding(
                "warning",
                f"OP stands at its {limit} limit in {100 * share:.2g} % of the record.",
                "At a limit the valve does not answer, which looks like a dead zone.",
                "Use a stretch within the limits, or identify a saturation as well.",
            )
