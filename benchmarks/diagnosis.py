"""The diagnosis: calibration of its weights on simulated loops, and what it reaches on simulated and real ones.

Run: ``.venv/bin/python benchmarks/diagnosis.py`` (about 8 minutes on two cores); writes docs/diagnosis.md.
``--calibrate`` simulates other loops (about 8 minutes), prints the table of ``diagnose/weights.py`` and writes nothing.
Options: ``--cases N``, ``--data FOLDER``, ``--workers N``.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from lostmotion.diagnose.features import Features
from lostmotion.diagnose.verdict import probabilities
from lostmotion.diagnose.weights import CLASSES, NAMES, WEIGHTS
from lostmotion.evaluate.workers import run_all
from verdicts import page
from verdicts.calibrate import as_code, calibrated
from verdicts.cases import Row, simulated
from verdicts.sets import isdb, sacac

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "diagnosis.md"
DATA = ROOT.parent / "shared" / "data"
CALIBRATION, EVALUATION = 1000, 50_000  # first seeds: no loop is in both


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calibrate", action="store_true")
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--workers", type=int, default=None)
    given = parser.parse_args()
    if given.calibrate:
        rows = run_all(simulated, range(CALIBRATION, CALIBRATION + given.cases), "calibration", given.workers)
        print(as_code(calibrated(rows)))
        return
    rows = run_all(simulated, range(EVALUATION, EVALUATION + given.cases), "simulated loops", given.workers)
    real = isdb(given.data)
    loops = sacac(given.data)
    OUTPUT.write_text(written(rows, real, loops), encoding="utf-8")
    print(page.score_table(rows), f"{sum(right for _, right in real)} of {len(real)}", sep="\n\n")
    print(f"SACAC: {sum(right for *_, right in loops)} of {len(loops)} loops")


def written(rows: list[Row], real: list[tuple[Row, bool]], loops: list[tuple[str, str, list[Row], bool]]) -> str:
    """The whole page."""
    template = (Path(__file__).parent / "verdicts" / "page.md").read_text(encoding="utf-8")
    parts = {
        "SCORES": page.score_table(rows),
        "CONFUSION": page.confusion(rows),
        "CASES": f"{len(rows)}",
        "ISDB_SCORE": f"{sum(right for _, right in real)} of {len(real)}",
        "ISDB": page.real_table(real),
        "SACAC_SCORE": f"{sum(right for *_, right in loops)} of {len(loops)}",
        "SACAC": page.loop_table(loops),
        "WEIGHTS": weight_table(),
        "ABLATION": ablation(rows, real),
    }
    for name, text in parts.items():
        template = template.replace(f"@{name}@", text)
    return template


def weight_table() -> str:
    lines = ["| evidence | " + " | ".join(CLASSES[1:]) + " |", "|---" * len(CLASSES) + "|"]
    for index, name in enumerate(("constant", *NAMES)):
        lines.append(
            f"| {name} | " + " | ".join(f"{row[index] - WEIGHTS[0, index]:+.2f}" for row in WEIGHTS[1:]) + " |"
        )
    return "\n".join(lines)


def ablation(rows: list[Row], real: list[tuple[Row, bool]]) -> str:
    """What each piece of evidence is worth: without it, the most probable class is right how often?"""
    lines = ["| without | simulated: class right | false alarms | 26 loops right |", "|---|---|---|---|"]
    lines += [f"| {name} | " + " | ".join(_without(name, rows, real)) + " |" for name in ("-", *NAMES)]
    return "\n".join(lines)


def _without(name: str, rows: list[Row], real: list[tuple[Row, bool]]) -> tuple[str, str, str]:
    def best(row: Row) -> str:
        values = dict(zip(NAMES, row.features, strict=True))
        found = probabilities(Features(**(values | ({name: 0.0} if name in values else {}))))
        return max(found, key=lambda one: found[one])

    classes: dict[str, str] = {"dead zone": "dead zone", "backlash": "sticking", "stiction": "sticking"}
    seen = [row for row in rows if row.features and row.visible and row.truth in classes]
    sound = [row for row in rows if row.features and row.truth in ("none", "tuning", "disturbance")]
    hits = sum(best(row) == classes[row.truth] for row in seen)
    alarms = sum(best(row) != "none" for row in sound)
    right = sum((best(row) == "sticking") == (row.truth == "stiction") for row, _ in real if row.features)
    return f"{100 * hits / len(seen):.0f} %", f"{100 * alarms / len(sound):.1f} %", f"{right}"


if __name__ == "__main__":
    main()
