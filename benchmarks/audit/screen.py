"""What reading, screening and assessing a loop cost, on a made plant; memory, and time over the number of loops.

Run: ``.venv/bin/python benchmarks/audit/screen.py FOLDER --loops 200 --assess 16``. FOLDER holds Parquet files of a
loop each, as ``benchmarks/audit/made_plant.py`` writes them; they are read again from the first where there are fewer
than asked for. Seconds are processor time of this process; a bar on two cores counts both.
"""

from __future__ import annotations

import argparse
import resource
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion.audit.assess.assess import assess
from lostmotion.audit.screen.screen import screen
from lostmotion.audit.screen.windows import Window, windows_of
from lostmotion.audit.settings import AuditSettings
from lostmotion.plant.loop import PlantLoop
from lostmotion.records import LoopRecord
from lostmotion.store.rows import AssessmentRow

SETTINGS = AuditSettings()
SCREEN_BAR, WHOLE_BAR = 0.138, 3.6  # s a loop: 26,000 screened, 1,000 audited in 30 minutes on two cores


def files_of(folder: Path, loops: int) -> Iterator[Path]:
    """So many files, from the first again where there are fewer."""
    found = sorted(folder.rglob("*.parquet"))
    if not found:
        raise SystemExit(f"expected Parquet files in {folder}, got none; make some with made_plant.py")
    for number in range(loops):
        yield found[number % len(found)]


def one(path: Path, further: bool) -> tuple[float, float, float, AssessmentRow]:
    """Seconds of reading, screening and assessing (0 where not asked for), and the row."""
    began = time.process_time()
    record: LoopRecord = lm.read_loop(path)
    window: Window = next(windows_of(record, SETTINGS))
    read = time.process_time() - began
    loop = PlantLoop(path.stem, op_span=(0.0, 100.0))
    row, _ = screen(loop, window.record, window.start, window.end, SETTINGS)
    screened = row.seconds
    if further and row.value > 0.0:
        row, _ = assess(loop, window.record, row, SETTINGS)
    return read, screened, row.seconds - screened, row


def main() -> None:
    """Print a line at every power of four of loops, and the sum."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--loops", type=int, default=200)
    parser.add_argument("--assess", type=int, default=16, help="loops, the first ones, that are assessed too")
    asked = parser.parse_args()
    one(next(files_of(asked.folder, 1)), True)  # kernels are compiled, or loaded
    seconds: list[tuple[float, float, float]] = []
    began = time.process_time()
    for number, path in enumerate(files_of(asked.folder, asked.loops), start=1):
        read, screened, assessed, row = one(path, number <= asked.assess)
        seconds.append((read, screened, assessed))
        if number <= asked.assess:
            print(
                f"{path.stem}: {row.verdict}, {row.size_percent or 0.0:.2f} %, value {row.value:.2f}, {assessed:.2f} s"
            )
        if number in {4**k for k in range(10)} | {asked.loops}:
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
            print(f"{number} loops: {time.process_time() - began:.1f} s, {peak:.0f} MB", flush=True)
    each = np.array(seconds)
    read, screened = each[:, 0].mean(), each[:, 1].mean()
    assessed = each[: asked.assess, 2].mean() if asked.assess else 0.0
    print(f"read {1000 * read:.0f} ms, screen {1000 * screened:.0f} ms, assess {assessed:.2f} s a loop")
    print(f"read and screen {1000 * (read + screened):.0f} ms of {1000 * SCREEN_BAR:.0f} ms")
    print(f"all {read + screened + assessed:.2f} s of {WHOLE_BAR} s")


if __name__ == "__main__":
    main()
