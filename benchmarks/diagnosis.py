"""The diagnosis: calibration of its weights on simulated loops, and what it reaches on simulated and real ones.

Run: ``.venv/bin/python benchmarks/diagnosis.py`` (about 13 minutes on two cores); writes docs/diagnosis.md.
``--calibrate`` simulates other loops (about 6 minutes), prints the table of ``diagnose/weights.py``, writes nothing.
Options: ``--cases N`` for a shorter run, which writes nothing; ``--data FOLDER``, ``--workers N``.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from lostmotion.diagnose.features import Features
from lostmotion.diagnose.verdict import SURE, fault_probability
from lostmotion.diagnose.weights import CONSTANT, NAMES, WEIGHTS
from lostmotion.evaluate.workers import run_all
from pages import publish
from verdicts import left_out, page
from verdicts.calibrate import SOUND, as_code, calibrated
from verdicts.cases import Row, for_calibration, rough, second, simulated
from verdicts.second_family import CELLS
from verdicts.sets import isdb, sacac

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "diagnosis.md"
DATA = ROOT.parent / "shared" / "data"
CALIBRATION, EVALUATION = 1000, 50_000  # first seeds: no loop is in both


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--save", type=Path, default=None, help="with --calibrate: keep the rows as JSON")
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args()
    if given.calibrate:
        rows = run_all(for_calibration, range(CALIBRATION, CALIBRATION + given.cases), "calibration", given.workers)
        if given.save is not None:
            given.save.write_text(json.dumps([asdict(row) for row in rows]), encoding="utf-8")
        print(as_code(*calibrated(rows)))
        return
    simulated(EVALUATION)  # compiles the kernels, which the workers are then born with
    rows = run_all(simulated, range(EVALUATION, EVALUATION + given.cases), "simulated loops", given.workers)
    wild = run_all(rough, range(EVALUATION, EVALUATION + given.cases // 2), "rough loops", given.workers)
    other = run_all(second, range(min(CELLS, given.cases)), "second family", given.workers)
    real = isdb(given.data)
    loops = sacac(given.data)
    if given.cases == parser.get_default("cases"):
        publish(OUTPUT, written(rows, wild, other, real, loops))
    print(page.score_table(rows), f"{sum(right for _, right in real)} of {len(real)}", sep="\n\n")
    print(f"SACAC: {sum(right for *_, right in loops)} of {len(loops)} loops")


def written(
    rows: list[Row],
    wild: list[Row],
    other: list[Row],
    real: list[tuple[Row, bool]],
    loops: list[tuple[str, str, list[Row], bool]],
) -> str:
    """The whole page."""
    template = (Path(__file__).parent / "verdicts" / "page.md").read_text(encoding="utf-8")
    parts = {
        "SCORES": page.score_table(rows),
        "CONFUSION": page.confusion(rows),
        "CASES": f"{len(rows)}",
        "ROUGH": page.score_table(wild),
        "ROUGH_CASES": f"{len(wild)}",
        "SECOND": page.score_table(other),
        "SECOND_CONFUSION": page.confusion(other),
        "SECOND_CASES": f"{len(other)}",
        "ISDB_SCORE": f"{sum(right for _, right in real)} of {len(real)}",
        "ISDB": page.real_table(real),
        "SACAC_SCORE": f"{sum(right for *_, right in loops)} of {len(loops)}",
        "SACAC": page.loop_table(loops),
        "WEIGHTS": weight_table(),
        "SURE": f"{SURE:g}",
        "ABLATION": ablation(rows, real),
        "LEFT_OUT": left_out.table([row for row, _ in real] + [runs[0] for _, _, runs, _ in loops]),
    }
    for name, text in parts.items():
        template = template.replace(f"@{name}@", text)
    return template


def weight_table() -> str:
    lines = ["| evidence | weight |", "|---|---|", f"| constant | {CONSTANT:+.2f} |"]
    lines += [f"| {name} | {weight:+.2f} |" for name, weight in zip(NAMES, WEIGHTS, strict=True)]
    return "\n".join(lines)


def ablation(rows: list[Row], real: list[tuple[Row, bool]]) -> str:
    """What each piece of evidence is worth: a fault of the actuator or not, with one weight set to 0."""
    lines = ["| without | faults found | false alarms | stiction or not, 26 loops |", "|---|---|---|---|"]
    lines += [f"| {name} | " + " | ".join(_without(name, rows, real)) + " |" for name in ("-", *NAMES)]
    return "\n".join(lines)


def _without(name: str, rows: list[Row], real: list[tuple[Row, bool]]) -> tuple[str, str, str]:
    def alarm(row: Row) -> bool:
        values = dict(zip(NAMES, row.features, strict=True))
        return fault_probability(Features(**(values | ({name: 0.0} if name in values else {})))) > SURE

    faults = [row for row in rows if row.features and row.visible and row.truth not in SOUND]
    sound = [row for row in rows if row.features and row.truth in SOUND]
    right = sum(alarm(row) == (row.truth == "stiction") for row, _ in real if row.features)
    found, false = sum(map(alarm, faults)), sum(map(alarm, sound))
    return f"{100 * found / len(faults):.0f} %", f"{100 * false / len(sound):.1f} %", f"{right}"


if __name__ == "__main__":
    main()
