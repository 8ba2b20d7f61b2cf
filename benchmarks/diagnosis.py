"""The diagnosis: calibration of its weights on simulated and real loops, and what it reaches on both.

Run: ``.venv/bin/python benchmarks/diagnosis.py`` (about 13 minutes on two cores); writes docs/diagnosis.md.
``--calibrate`` diagnoses other simulated loops, and the real ones (about 6 minutes), prints the lines of
``diagnose/weights.py`` and how reliable they are, and writes nothing. Options: ``--cases N`` for a shorter run, which
writes nothing; ``--data FOLDER``, ``--workers N``.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from lostmotion.diagnose.features import Features
from lostmotion.diagnose.verdict import CLEARED, SURE, fault_probability
from lostmotion.diagnose.weights import CONSTANTS, NAMES, SIMULATED, WEIGHTS
from lostmotion.evaluate.workers import run_all
from pages import publish
from verdicts import page, reliability
from verdicts.calibrate import SOUND, Weights, of_simulated, with_real
from verdicts.cases import Row, for_calibration, rough, second, simulated
from verdicts.second_family import CELLS
from verdicts.sets import by_loop, diagnosed, together

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "diagnosis.md"
DATA = ROOT.parent / "shared" / "data"
CALIBRATION, EVALUATION = 1000, 50_000  # first seeds: no loop is in both
SETS = {"ISDB": "isdb26", "MORE": "isdb_more", "SACAC": "sacac", "REFINERY": "refinery"}
Pooled = Mapping[tuple[str, str], str]
PRIOR = Weights(SIMULATED[:2], np.array(SIMULATED[2:]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args()
    simulated(EVALUATION)  # compiles the kernels, which the workers are then born with
    if given.calibrate:
        seeds = range(CALIBRATION, CALIBRATION + given.cases)
        calibrate(run_all(for_calibration, seeds, "calibration", given.workers), diagnosed(given.data, given.workers))
        return
    rows = run_all(simulated, range(EVALUATION, EVALUATION + given.cases), "simulated loops", given.workers)
    wild = run_all(rough, range(EVALUATION, EVALUATION + given.cases // 2), "rough loops", given.workers)
    other = run_all(second, range(min(CELLS, given.cases)), "second family", given.workers)
    real = diagnosed(given.data, given.workers)
    pooled = together(given.data, given.workers)
    if given.cases == parser.get_default("cases"):
        publish(OUTPUT, written(rows, wild, other, real, pooled))
    print(page.score_table(rows))
    print(page.tally(loops_of(real, pooled)))


def calibrate(rows: list[Row], real: list[Row]) -> None:
    """Print the weights, and how reliable they are."""
    prior, real = of_simulated(rows), [row for row in real if row.features]
    print(
        "# of simulated loops alone",
        prior.as_code(),
        "# discounted as real loops show",
        with_real(prior, real).as_code(),
        sep="\n",
    )
    print(reliability.score_table(prior, real), reliability.diagram(prior, real), sep="\n\n")


def written(rows: list[Row], wild: list[Row], other: list[Row], real: list[Row], pooled: Pooled) -> str:
    """The whole page."""
    template = (Path(__file__).parent / "verdicts" / "page.md").read_text(encoding="utf-8")
    told = [row for row in real if row.features]
    parts = {
        "SCORES": page.score_table(rows),
        "CONFUSION": page.confusion(rows),
        "CASES": f"{len(rows)}",
        "ROUGH": page.score_table(wild),
        "ROUGH_CASES": f"{len(wild)}",
        "SECOND": page.score_table(other),
        "SECOND_CONFUSION": page.confusion(other),
        "SECOND_CASES": f"{len(other)}",
        "WEIGHTS": weight_table(),
        "SURE": f"{SURE:g}",
        "CLEARED": f"{CLEARED:g}",
        "ABLATION": ablation(rows, by_loop(real, "isdb26", pooled)),
        "RELIABILITY": reliability.score_table(PRIOR, told),
        "DIAGRAM": reliability.diagram(PRIOR, told),
    }
    sets = loops_of(real, pooled)
    parts |= {
        "TALLY": page.tally(sets),
        **{name: page.loop_table(sets[source], of_set(pooled, source)) for name, source in SETS.items()},
    }
    for name, text in parts.items():
        template = template.replace(f"@{name}@", text)
    return template


def loops_of(real: list[Row], pooled: Pooled) -> dict[str, list[tuple[str, str, list[Row], str]]]:
    """Physical loops of every set."""
    return {source: by_loop(real, source, pooled) for source in SETS.values()}


def of_set(pooled: Pooled, source: str) -> dict[str, str]:
    """What all records of a loop say together, by the name of the loop."""
    return {name: verdict for (where, name), verdict in pooled.items() if where == source}


def weight_table() -> str:
    lines = ["| evidence | weight | of simulated loops alone |", "|---|---|---|"]
    both = zip(("sticking", "other fault", *NAMES), (*CONSTANTS, *WEIGHTS), SIMULATED, strict=True)
    lines += [f"| {name} | {weight:+.2f} | {alone:+.2f} |" for name, weight, alone in both]
    return "\n".join(lines)


def ablation(rows: list[Row], loops: list[tuple[str, str, list[Row], str]]) -> str:
    """What each piece of evidence is worth: a fault of the actuator or not, with one weight set to 0."""
    lines = ["| without | faults found | false alarms | stiction or not, 26 loops |", "|---|---|---|---|"]
    real = [runs[0] for _, _, runs, _ in loops]
    lines += [f"| {name} | " + " | ".join(_without(name, rows, real)) + " |" for name in ("-", *NAMES)]
    return "\n".join(lines)


def _without(name: str, rows: list[Row], real: list[Row]) -> tuple[str, str, str]:
    def alarm(row: Row) -> bool:
        values = dict(zip(NAMES, row.features, strict=True))
        return fault_probability(Features(**(values | ({name: 0.0} if name in values else {})))) > SURE

    faults = [row for row in rows if row.features and row.visible and row.truth not in SOUND]
    sound = [row for row in rows if row.features and row.truth in SOUND]
    right = sum(alarm(row) == (row.truth == "stiction") for row in real if row.features)
    found, false = sum(map(alarm, faults)), sum(map(alarm, sound))
    return f"{100 * found / len(faults):.0f} %", f"{100 * false / len(sound):.1f} %", f"{right}"


if __name__ == "__main__":
    main()
