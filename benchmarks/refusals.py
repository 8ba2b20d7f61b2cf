"""Which of the real records read_loop takes without a word about columns or times, and why not the others.

Run: ``.venv/bin/python benchmarks/refusals.py`` (seconds); prints only. ``--data FOLDER``: where the records lie.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import lostmotion as lm
from lostmotion.errors import LostMotionError

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
FOLDERS = ("isdb26", "isdb_more", "sacac", "refinery", "historian_week", "damadics", "dcmotor", "cascaded_tanks")
NO_RECORDS = ("labels.csv", "index.csv")


def refusal(path: Path) -> str:
    """Why a file is refused; empty where it is read."""
    try:
        lm.read_loop(path)
    except LostMotionError as error:
        return f"{type(error).__name__}: {error}"
    return ""


def main() -> None:
    """Print a line for each folder and one for each refused file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, default=DATA)
    data = parser.parse_args().data
    total = taken = 0
    for folder in FOLDERS:
        found = {path: refusal(path) for path in sorted((data / folder).rglob("*.csv")) if path.name not in NO_RECORDS}
        read = sum(not reason for reason in found.values())
        total, taken = total + len(found), taken + read
        print(f"{folder}: {read} of {len(found)} read")
        for path, reason in found.items():
            if reason:
                print(f"    {path.name}: {reason}")
    print(f"All: {taken} of {total} read without a word.")


if __name__ == "__main__":
    main()
