"""Weights of the simulated loops beside weights that were fitted to real loops of every other source."""

from __future__ import annotations

import numpy as np

from lostmotion.diagnose.features import Features
from lostmotion.diagnose.verdict import SURE, fault_probability
from verdicts.calibrate import Array, logistic
from verdicts.cases import Row

FAULTS = ("stiction", "saturation")  # labels that put the blame on the actuator
INDUSTRY = {"CHEM": "chemicals", "PAP": "paper", "MIN": "minerals", "chemical": "chemicals"}


def source_of(name: str) -> str:
    """Industry that a loop of ISDB or SACAC comes from, by its name."""
    word = name.split("-")[2] if "-" in name else name.rstrip("0123456789")
    return INDUSTRY.get(word, word)


def table(rows: list[Row]) -> str:
    """Loops of each source called faulty or not as labelled, by weights in whose making that source had no part."""
    rows = [row for row in rows if row.features]
    sources = np.array([source_of(row.name) for row in rows])
    fault = np.array([row.truth in FAULTS for row in rows])
    features = np.array([row.features for row in rows])
    simulated = np.array([fault_probability(Features(*row.features)) > SURE for row in rows]) == fault
    lines = [
        "| source left out | loops | weights of simulated loops | fitted to the other sources |",
        "|---|---|---|---|",
    ]
    others = np.zeros(len(rows), dtype=bool)
    for source in sorted(set(sources.tolist())):
        here = sources == source
        others[here] = _alarms(features[~here], fault[~here], features[here]) == fault[here]
        lines.append(f"| {source} | {here.sum()} | {simulated[here].sum()} | {others[here].sum()} |")
    lines.append(f"| all | {len(rows)} | {simulated.sum()} | {others.sum()} |")
    itself = _alarms(features, fault, features) == fault
    lines.append(f"| none: fitted to all and scored on all | {len(rows)} | - | {itself.sum()} |")
    return "\n".join(lines)


def _alarms(features: Array, fault: np.ndarray, new: Array) -> np.ndarray:
    """Faults among `new` loops, by weights fitted to others."""
    constant, weights = logistic(features, fault.astype(np.float64), np.ones(len(fault)))
    return np.asarray(constant + new @ weights > np.log(SURE / (1.0 - SURE)))
