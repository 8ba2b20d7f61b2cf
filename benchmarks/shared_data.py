"""Every real record in ../shared/data through read, check, prepare and identify; nothing is skipped silently.

Run: ``.venv/bin/python benchmarks/shared_data.py`` (about 5 minutes); writes docs/shared-data.md.
Options: ``--data FOLDER``, ``--only PART`` of a name (writes nothing), ``--report`` to print the whole reports.
"""

from __future__ import annotations

import argparse
import csv
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.records import Prepared, prepare
from pages import publish

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "shared-data.md"
DATA = ROOT.parent / "shared" / "data"

# dt in seconds that the provenance of the files gives where their time column is no clock
SACAC_DT = {
    "quantisation-F-minerals": 10.0,
    "saturation-L-minerals": 10.0,
    "stiction-P-oilgas": 12.0,
    "tuning-F-chemical-DB": 1.0,
    "stiction-L-paper-horch": 2.0,
    "other-F-chemicals-thornhill": 20.0,
    "saturation-T-oilgas-thornhill": 20.0,
    "sensor-F-oilgas-thornhill": 20.0,
    "stiction-L-chemicals-thornhill": 20.0,
}
# labels.csv says 1 s, the time column 30 s
ISDB_DT = {"CHEM10": 30.0, "CHEM11": 30.0, "CHEM12": 30.0, "CHEM8": 30.0}
HALF = {"BAS8": 0.5, "CHEM37": 0.4}  # the recorder of one stops again and again, the clock of the other jitters
WEEK = {"FIC-211": ("FV_211", "FT_211"), "LIC-106": ("LV_106", "FT_115")}
GLUED = "tuning-L-paper-horch"  # two recordings in one file; its times jump


@dataclass(frozen=True)
class Entry:
    """One record: what it is called, what is known of it, how it is read, and why the reader refuses it."""

    name: str
    label: str
    path: Path
    options: dict[str, Any] = field(default_factory=dict)
    refusal: str = ""
    used: float = 0.6  # share of the rows that can be used, at least


@dataclass(frozen=True)
class Outcome:
    """One row of the table."""

    entry: Entry
    record: lm.LoopRecord | None
    prepared: Prepared | None
    fit: lm.HammersteinFit | None
    reason: str
    seconds: float


def entries(data: Path) -> Iterator[Entry]:
    """Every record in the folder."""
    with (data / "isdb26" / "labels.csv").open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            dt = ISDB_DT.get(row["loop"], float(row["dt_s"]))
            label = "dead zone (contributor)" if row["loop"] == "PAP4" else row["label"]
            yield Entry(row["loop"], label, data / "isdb26" / row["file"], {"dt": dt})
    for path in sorted((data / "sacac").glob("*-*.csv")):
        dt = next((value for start, value in SACAC_DT.items() if path.stem.startswith(start)), None)
        options = {"dt": 1.0, "time": False} if path.stem.startswith(GLUED) else {"dt": dt}
        yield Entry(path.stem, path.stem.split("-")[0], path, options)
    damadics = data / "damadics" / "lublin_actuator3_2001-10-11_1h.csv"
    columns = {"op": "LC74_20CV_pct", "pv": "LC74_20X_pct", "sp": None, "op_span": (0.0, 100.0)}
    yield Entry("damadics, positioner", "healthy", damadics, columns | {"pv_span": (0.0, 100.0)})
    motor = data / "dcmotor" / "run_minimal.csv"
    yield Entry("dcmotor", "dead zone 2 .. 4 V", motor, {"op": "voltage", "pv": "rpm"})
    for kind in ("Est", "Val"):
        tanks = data / "cascaded_tanks" / "dataBenchmark.csv"
        yield Entry(f"cascaded tanks, {kind}", "no dead zone", tanks, {"op": f"u{kind}", "pv": f"y{kind}"})
    yield from _isdb_more(data)
    yield from _refinery(data)
    for tag, (op, pv) in WEEK.items():
        path = data / "historian_week" / f"{tag}.csv"
        yield Entry(f"historian week, {tag}", "not known", path, {"op": op, "pv": pv})


def _isdb_more(data: Path) -> Iterator[Entry]:
    """The loops of the International Stiction Data Base that are not in the comparison set."""
    with (data / "isdb_more" / "labels.csv").open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            dt = ISDB_DT.get(row["loop"], float(row["dt_s"]))
            yield Entry(
                row["loop"],
                row["label"],
                data / "isdb_more" / f"{row['loop']}.csv",
                {"dt": dt},
                used=HALF.get(row["loop"], 0.6),
            )


def _refinery(data: Path) -> Iterator[Entry]:
    """Two hours each of the loops of a refinery."""
    with (data / "refinery" / "labels.csv").open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            yield Entry(Path(row["file"]).stem, row["label"], data / "refinery" / row["file"], {"mode": "mode"})


def run(entry: Entry) -> Outcome:
    """Read, prepare, identify; a refusal is an outcome, any other exception ends the run."""
    begun = time.perf_counter()
    record: lm.LoopRecord | None = None
    prepared: Prepared | None = None
    fit: lm.HammersteinFit | None = None
    reason = ""
    try:
        record = lm.read_loop(entry.path, **entry.options)
        assert lm.check(record).summary()
        prepared = prepare(record)
        fit = lm.identify(prepared, nonlinearity="dead zone")
    except lm.InputError as refused:
        reason = str(refused)
    return Outcome(entry, record, prepared, fit, reason, time.perf_counter() - begun)


def row(outcome: Outcome) -> str:
    """One line of the table."""
    record, fit = outcome.record, outcome.fit
    size = ["-", "-"] if record is None else [f"{len(record)}", f"{record.dt:g}"]
    said = [] if outcome.prepared is None else list(outcome.prepared.notes)
    if fit is None:
        found = ["refused", "-", "-", "-"]
        said = [outcome.reason]
    else:
        found = [fit.status.name, *width(fit), f"{fit.fit_percent:.0f}" if fit.fit_percent > -100 else "< -100"]
        said += [note for note in fit.data.notes if note not in said and note not in (record.notes if record else ())]
        said += fit.remarks
    cells = [outcome.entry.name, outcome.entry.label, *size, *found, " ".join(said).replace("|", "/") or "-"]
    return "| " + " | ".join([*cells, f"{outcome.seconds:.1f}"]) + " |"


def width(fit: lm.HammersteinFit) -> list[str]:
    """Width in units of OP and in % of its span, or of its range in the record where the span is not known."""
    span, of = fit.data.op_span, "%"
    size = float(np.ptp(fit.data.u)) if span is None else span[1] - span[0]
    if span is None:
        of = "% of range"
    low, high = fit.interval("width")
    if fit.evidence.other_kind is not None:
        return [f"likelier: {fit.evidence.other_kind[0]}", "-"]
    if fit.status is lm.Status.CANNOT_TELL or not high < float(np.ptp(fit.data.u)):
        return ["not bounded", "-"]
    if fit.preferred != "dead zone":
        return [f"< {high:.2g}", f"< {100 * high / size:.2g} {of}"]
    value = fit.parameters["width"]
    return [f"{value:.3g} ({low:.3g} .. {high:.3g})", f"{100 * value / size:.2g} {of}"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=DATA)
    parser.add_argument("--only", default="")
    parser.add_argument("--report", action="store_true")
    arguments = parser.parse_args()
    if not arguments.data.is_dir():
        sys.exit(f"expected the real records in {arguments.data}, got no such folder; name it with --data")
    chosen = [entry for entry in entries(arguments.data) if arguments.only in entry.name]
    lines = []
    for index, entry in enumerate(chosen, 1):
        outcome = run(entry)
        lines.append(row(outcome))
        print(f"[{index}/{len(chosen)}] {lines[-1]}", flush=True)
        if arguments.report and outcome.fit is not None:
            print(outcome.fit.summary())
    if not arguments.only:
        publish(OUTPUT, PAGE.format(rows="\n".join(lines), count=len(lines)))


PAGE = """# Real records

Made by `.venv/bin/python benchmarks/shared_data.py` from the records in `../shared/data`, which are cited there and are
not part of this repository. All {count} records, each read, checked, prepared and identified with every setting on
"auto" but the kind, a dead zone, in one process on one thread. Labels are those of the contributors; "stiction" is no
dead zone, and where another kind is likelier (OTHER_KIND) it is named in the place of a width. The same loop can occur
twice (CHEM10 and stiction-P-chemical, CHEM14 and sensor-F-oilgas, the runs 1 to 12 and 1 to 7 of two loops).

Width in units of OP with its 95 % interval, then in % of the span of OP, or of the range of OP in the record where
the span is not known; "<" is the widest dead zone that the record does not exclude. Fit: how much of PV the model
simulates from OP alone, in %.

| record | label | rows | dt, s | status | width | relative | fit | left out, changed, to be known | s |
|---|---|---|---|---|---|---|---|---|---|
{rows}
"""


if __name__ == "__main__":
    main()
