"""Page of ``benchmarks.off_model``: ``identify`` on real motors and on plants that are not quite of its model's shape.

Run: ``.venv/bin/python benchmarks/real_plants.py`` (about 30 minutes); writes docs/off-model.md. ``--workers N``.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers
sys.path.insert(0, str(Path(__file__).parent.parent))

from benchmarks.off_model.__main__ import SEEDS, SUITES, compile_kernels, run  # noqa: E402

from pages import publish  # noqa: E402

OUTPUT = Path(__file__).parent.parent / "docs" / "off-model.md"
SHOWN = ("wheels", "held_out", "asymmetric", "off_model", "thinning", "levels", "servos")
HEAD = """# Real actuators, and plants that are not quite of the model's shape

Made by `.venv/bin/python benchmarks/real_plants.py`. Motors and servos are real records whose truth is seen in the
data (../shared/actuators); the plants are simulated by `benchmarks/off_model/plant.py`, which shares nothing with the
package. "OK and wrong": status OK with another kind, or an interval that does not hold the truth.

"""


def main() -> None:
    """Run the suites and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workers", type=int, default=2)
    workers = parser.parse_args().workers
    compile_kernels()
    summary, parts = ["| records | what | measured | bar | |", "|---|---|---|---|---|"], []
    for name in SHOWN:
        suite = SUITES[name]
        lines = suite.report(run(suite, [job for together in suite.jobs(SEEDS) for job in together], workers))
        at = next(k for k, line in enumerate(lines) if line.startswith("| summary"))
        summary += [f"| {name} {line}" for line in lines[at + 2 :] if line.startswith("|")]
        where = sys.modules[suite.jobs.__module__].__doc__ or ""
        parts += [f"## {name}", "", " ".join(where.split()), "", *lines[:at]]
    publish(OUTPUT, HEAD + "\n".join([*summary, "", *parts]) + "\n")


if __name__ == "__main__":
    main()
