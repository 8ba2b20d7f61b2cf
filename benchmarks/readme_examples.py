"""The loops that the README shows: a simulated sticking valve diagnosed, and three real records with a known truth.

Run: ``.venv/bin/python benchmarks/readme_examples.py`` (about 1 minute); writes docs/readme-examples.md.
Option: ``--data FOLDER``.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.evaluate import random_faulty_loop
from pages import publish

ROOT = Path(__file__).resolve().parent.parent
OUTPUT = ROOT / "docs" / "readme-examples.md"
DATA = ROOT.parent / "shared" / "data"
DAMADICS = {"op": "LC74_20CV_pct", "pv": "LC74_20X_pct", "sp": None, "op_span": (0.0, 100.0), "pv_span": (0.0, 100.0)}
RECORDS: dict[str, tuple[str, dict[str, Any]]] = {
    "ISDB PAP4": ("isdb26/PAP4.csv", {"dt": 1.0}),
    "DC motor": ("dcmotor/run_minimal.csv", {"op": "voltage", "pv": "rpm"}),
    "DAMADICS": ("damadics/lublin_actuator3_2001-10-11_1h.csv", DAMADICS),
}


def diagnosed() -> tuple[float, str]:
    """Band of the simulated valve in % of span, and the report of its loop."""
    loop = random_faulty_loop(4, cause="stiction", process="flow")
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    return loop.width, lm.diagnose(record).summary()


def row(name: str, fit: lm.HammersteinFit) -> str:
    """One record: what was found, with standard errors, and what else fits."""
    evidence, high = fit.evidence, fit.interval("width")[1]
    zone = [f"{fit.parameters[key]:.2f} ({fit.standard_errors[key]:.2f})" for key in ("left", "right", "width")]
    found = zone if fit.preferred == "dead zone" else ["-", "-", f"not seen, below {high:.1f}"]
    others = ", ".join(f"{left:.1f} .. {right:.1f} ({behind:.0f})" for left, right, behind in evidence.rivals)
    gain = f"{evidence.gain_over_linear:.0f}"
    share = f"{high / np.ptp(fit.data.op_span) * 100:.1f}" if fit.data.op_span else "-"
    cells = [name, fit.status.name, *found, gain, f"{fit.fit_percent:.0f}", share, others or "-"]
    return "| " + " | ".join(cells) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, default=DATA)
    data = parser.parse_args().data
    if not data.is_dir():
        sys.exit(f"expected the real records in {data}, got no such folder; name it with --data")
    band, report = diagnosed()
    fits = {
        name: lm.identify(lm.read_loop(data / path, **options), nonlinearity="dead zone")
        for name, (path, options) in RECORDS.items()
    }
    rows = "\n".join(row(name, fit) for name, fit in fits.items())
    text = PAGE.format(band=band, report=report, rows=rows)
    publish(OUTPUT, text)
    print(text)


PAGE = """# The examples of the README

Made by `.venv/bin/python benchmarks/readme_examples.py`.

## A sticking valve, diagnosed

`lostmotion.evaluate.random_faulty_loop(4, cause="stiction", process="flow")`: 2,000 samples of a simulated flow loop
whose valve sticks by {band:.2f} % of span. The whole report of `lostmotion diagnose`:

```
{report}
```

## Real records

Everything "auto". Break points and width in units of OP with standard errors; gain over the linear model in BIC; fit:
how much of PV the model simulates from OP alone, in %; upper end of the 95 % interval of the width in % of the span of
OP, where that is known; other dead zones that fit about as well, with the BIC by which they are behind. Truth and
sources: README and `tests/published/test_real_records.py`.

| record | status | left | right | width | over linear | fit, % | below, % of span | others |
|---|---|---|---|---|---|---|---|---|
{rows}
"""


if __name__ == "__main__":
    main()
