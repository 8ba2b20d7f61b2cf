"""The real sets with their labels, and what counts as right for each label."""

from __future__ import annotations

import csv
from collections import Counter, defaultdict
from pathlib import Path

from lostmotion.identify.actuators.kind import faults
from shared_data import entries
from verdicts.cases import Row, real

STICKING = ("stiction", "backlash")
COUNTED_IN_ISDB = ("stiction-P-chemical", "sensor-F-oilgas")  # value-identical to CHEM10 and CHEM14


def isdb(data: Path) -> list[tuple[Row, bool]]:
    """The 26 loops: stiction must be called stiction or backlash, the others must not."""
    with (data / "isdb26" / "labels.csv").open(newline="", encoding="utf-8") as stream:
        labels = {row["loop"]: row for row in csv.DictReader(stream)}
    rows = []
    for entry in entries(data):
        if entry.name in labels:
            label = labels[entry.name]
            kind = label["type"] if label["type"] in ("flow", "pressure", "temperature", "level") else "other"
            known = {"loop_type": kind, "integrating": label["integrating"] == "True"}
            row = real(entry.name, label["label"], kind, entry.path, entry.options, known)
            rows.append((row, (row.verdict in STICKING) == (label["label"] == "stiction")))
    return rows


def sacac(data: Path) -> list[tuple[str, str, list[Row], bool]]:
    """Physical loops of SACAC that are not in the 26: name, label, runs, right in most of its runs."""
    loops: dict[str, list[Row]] = defaultdict(list)
    for entry in entries(data):
        if entry.path.parent.name != "sacac" or entry.name.startswith(COUNTED_IN_ISDB):
            continue
        letter = entry.name.split("-")[1]
        known = {"loop_type": {"F": "flow", "P": "pressure", "T": "temperature", "L": "level"}.get(letter, "other")}
        row = real(entry.name, entry.label, letter, entry.path, entry.options, known)
        loops[physical(entry.name)].append(row)
    found = []
    for name, rows in loops.items():
        right = Counter(right_for(rows[0].truth, row.verdict) for row in rows)
        found.append((name, rows[0].truth, rows, right[True] > right[False]))
    return found


def physical(name: str) -> str:
    """Name of the physical loop: runs of one loop differ in a number behind DB."""
    head, separator, _ = name.partition("-DB-")
    return head + (separator and "-DB")


def right_for(label: str, verdict: str) -> bool:
    """Whether a verdict is right for a label of SACAC."""
    if label == "stiction":
        return verdict in STICKING
    if label == "saturation":
        return verdict == "saturation"
    return verdict not in [kind.name for kind in faults()]
