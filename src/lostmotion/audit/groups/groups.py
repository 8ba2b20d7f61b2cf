"""Loops that swing together, and the likely source of each group: from the rows of the store alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import datetime

from lostmotion.audit.groups.carried import Peaks, carried
from lostmotion.audit.groups.likely_source import Suspect, name, suspect
from lostmotion.audit.groups.swinging import swinging, together, unsteady
from lostmotion.plant.loop import PlantLoop
from lostmotion.store.rows import AssessmentRow, GroupRow, SpectrumRow


def groups(
    spectra: Sequence[SpectrumRow], rows: Sequence[AssessmentRow], loops: Mapping[str, PlantLoop] | None = None
) -> tuple[GroupRow, ...]:
    """Find loops that swing together, and where it comes from.

    Parameters
    ----------
    spectra : sequence of SpectrumRow
    rows : sequence of AssessmentRow
        Of the same run; several windows of a loop are one member each.
    loops : mapping of str to PlantLoop, optional
        By their tags: where their data lie.

    Returns
    -------
    tuple of GroupRow
        Most power first; none where no two loops swing together.

    Notes
    -----
    A group: periods within 20 % (so far estimates of one swing lie apart), at least half of the time in common, and a
    swing that is shared: coherence about the period, at whatever lag, of 0.4 and more, which loops that share nothing
    have by a chance of 5 % at most. Like spectra are not asked for: loads that wander alike have them. Records without
    dates have no time in common with others, but for those of the same file; in memory for those that are as long.
    Loops that do something else most of the time, but whose spectrum has a clear peak at the period, are carried along
    where they share the swing.

    The source: each loop has log odds from its diagnosis and from how much of its variance the oscillation is; one
    alternative is that it comes from outside, which coupled phases (Choudhury, Shah and Thornhill 2004) and an
    amplitude that stays speak for where no diagnosis is sure of a valve. Where the amplitude comes and goes without
    coupled phases, or with a period as regular as that of a loop that rings (what swings wide is bent by the
    characteristic of its valve), a linear loop rings, and the purest is the source; where it stays, tuning is not
    blamed.
    Harmonics (Thornhill, Cox and Paulonis 2003) add nothing beside the diagnoses in simulated plants. Lags between
    loops decide nothing: the sign of what one does to the other is not known, so they are known up to half a period
    only. Two loops that are close are not decided between. What it finds: benchmarks/audit/groups.py.
    """
    made = []
    for period, members in suspects_of(spectra, rows, loops or {}):
        power = sum(one.loop.power for one in members if one.own)
        named = name(members)
        made.append((power, GroupRow(0, period, named.tag, named.confidence, named.why, tuple(_members(members)))))
    made.sort(key=lambda one: (-one[0], one[1].period))
    return tuple(replace(one, number=number + 1) for number, (_, one) in enumerate(made))


def suspects_of(
    spectra: Sequence[SpectrumRow], rows: Sequence[AssessmentRow], loops: Mapping[str, PlantLoop]
) -> Iterator[tuple[float, tuple[Suspect, ...]]]:
    """Period of each group, and its loops with what speaks for them as its source."""
    known = swinging(spectra, rows, loops)
    others = Peaks(unsteady(spectra, rows, known, loops))
    for period, members in together(known):
        along = carried(members[0][0], period, others)
        if len({one.tag for one, _ in [*members, *along]}) > 1:
            found = [suspect(one, like, own=True, master=_is_master(loops, one.tag)) for one, like in members]
            yield period, (*found, *(suspect(one, like, own=False) for one, like in along))


def _is_master(loops: Mapping[str, PlantLoop], tag: str) -> bool:
    return tag in loops and bool(loops[tag].slave)


def _members(suspects: Sequence[Suspect]) -> list[tuple[str, datetime, float, float]]:
    """Every window of each loop, the most suspect loop first."""
    order = sorted(suspects, key=lambda one: (-one.score, one.loop.tag))
    return [(one.loop.tag, row.window_start, one.likeness, one.score) for one in order for row in one.loop.rows]
