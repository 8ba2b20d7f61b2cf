"""The real loops with their labels, who gave them, and what counts as right for each label."""

from __future__ import annotations

import csv
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import lostmotion as lm
from lostmotion.evaluate.workers import run_all
from lostmotion.identify.actuators.kind import faults
from shared_data import Entry, entries
from verdicts.cases import Row, real

STICKING = ("stiction", "backlash")
COUNTED_IN_ISDB = ("stiction-P-chemical", "sensor-F-oilgas")  # value-identical to CHEM10 and CHEM14
LETTERS = {"F": "flow", "P": "pressure", "T": "temperature", "L": "level"}  # of a tag
TYPES = tuple(LETTERS.values())


@dataclass(frozen=True)
class Labelled:
    """One record to be diagnosed.

    Attributes
    ----------
    source : str
        Folder of the data.
    loop, contributor : str
        Physical loop, of which there may be several runs, and who gave it.
    known : dict
        What the diagnosis is told.
    """

    entry: Entry
    source: str
    loop: str
    label: str
    contributor: str
    known: dict[str, Any] = field(default_factory=dict)


def labelled(data: Path) -> list[Labelled]:
    """All records of the four labelled sets."""
    known = {entry.path: entry for entry in entries(data)}
    return [*_isdb(data / "isdb26", known), *_isdb(data / "isdb_more", known), *_sacac(known), *_refinery(data, known)]


def diagnosed(data: Path, workers: int | None = None) -> list[Row]:
    """Rows of all labelled records."""
    records = labelled(data)
    return run_all(partial(_row, records), range(len(records)), "real records", workers)


def together(data: Path, workers: int | None = None) -> dict[tuple[str, str], str]:
    """Verdicts on the loops, by set and name, of which there are several records: of all of these together."""
    loops: dict[tuple[str, str], list[Labelled]] = defaultdict(list)
    for one in labelled(data):
        loops[one.source, one.loop].append(one)
    several = {key: found for key, found in loops.items() if len(found) > 1}
    return dict(zip(several, run_all(_pooled, list(several.values()), "records of one loop", workers), strict=True))


def _pooled(records: list[Labelled]) -> str:
    try:
        read = [lm.read_loop(one.entry.path, **one.entry.options) for one in records]
        return lm.diagnose(read, **records[0].known).verdict
    except lm.InputError:
        return "refused"


def _row(records: list[Labelled], index: int) -> Row:
    one = records[index]
    row = real(one.entry.name, one.label, one.source, one.entry.path, one.entry.options, one.known)
    return replace(row, loop=one.loop, contributor=one.contributor)


def _rows(path: Path) -> Iterator[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as stream:
        yield from csv.DictReader(stream)


def _isdb(folder: Path, known: dict[Path, Entry]) -> Iterator[Labelled]:
    for row in _rows(folder / "labels.csv"):
        entry = known[folder / row.get("file", f"{row['loop']}.csv")]
        kind = row["type"] if row["type"] in TYPES else "other"
        said = row.get("contributor") or row.get("contributor_comment", "")
        person = re.search(r"[A-Z]\. [A-Z][a-z]+", said)
        by = person[0] if person else re.sub(r"\d+$", "", row["loop"])
        told = {"loop_type": kind, "integrating": row["integrating"] == "True"}
        yield Labelled(entry, folder.name, row["loop"], row["label"], by, told)


def _sacac(known: dict[Path, Entry]) -> Iterator[Labelled]:
    for path, entry in known.items():
        if path.parent.name == "sacac" and not entry.name.startswith(COUNTED_IN_ISDB):
            words = entry.name.split("-")
            by = next(word for word in reversed(words) if word.isalpha())
            told = {"loop_type": LETTERS.get(words[1], "other")}
            yield Labelled(entry, "sacac", physical(entry.name), entry.label, by, told)


def _refinery(data: Path, known: dict[Path, Entry]) -> Iterator[Labelled]:
    for row in _rows(data / "refinery" / "labels.csv"):
        told = {"loop_type": LETTERS.get(row["type"][0], "other")}
        yield Labelled(
            known[data / "refinery" / row["file"]], "refinery", row["tag"], row["label"], "the refinery", told
        )


def by_loop(
    rows: list[Row], source: str, pooled: Mapping[tuple[str, str], str]
) -> list[tuple[str, str, list[Row], str]]:
    """Physical loops of one set: name, label, runs, and "yes", "no" or "open".

    Of several runs what all say together decides; where they cannot tell, what most of them are.
    """
    loops: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if row.source == source:
            loops[row.loop].append(row)
    return [(name, runs[0].truth, runs, _right(runs, pooled.get((source, name), ""))) for name, runs in loops.items()]


def _right(runs: list[Row], together: str) -> str:
    of_all = is_right(runs[0].truth, together) if together else "open"
    return of_all if of_all in ("yes", "no") else _most(runs)


def _most(runs: list[Row]) -> str:
    """What most of the runs are that say anything; open where most say nothing."""
    counts = Counter(is_right(row.truth, row.verdict) for row in runs)
    if counts["open"] + counts["refused"] > 0.5 * len(runs):
        return "open"
    return "yes" if counts["yes"] > counts["no"] else "no"


def physical(name: str) -> str:
    """Name of the physical loop: runs of one loop differ in a number behind DB."""
    head, separator, _ = name.partition("-DB-")
    return head + (separator and "-DB")


def is_right(label: str, verdict: str) -> str:
    """Whether a verdict is right for a label: "yes", "no", "open" where it cannot tell, "refused".

    Stiction must be called stiction or backlash, saturation saturation, and nothing else a fault that sticks or an
    actuator's fault at all; the dead zone of PAP4, which its contributor names, may be called one.
    """
    if verdict in ("cannot tell", "refused"):
        return "open" if verdict == "cannot tell" else "refused"
    if label == "stiction":
        right = verdict in STICKING
    elif label == "saturation":
        right = verdict == "saturation"
    elif label == "not stiction":
        right = verdict not in STICKING
    else:
        right = verdict not in [kind.name for kind in faults()]
    return "yes" if right else "no"
