"""The stretch of a record that figures and pages of a diagnosis show."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.records import LoopRecord, prepare

if TYPE_CHECKING:
    from lostmotion.diagnose.diagnosis import Diagnosis

PERIODS = 12
MOST_ROWS = 1500  # shown where nothing swings
FEWEST_ROWS = 100


def shown_rows(diagnosis: Diagnosis) -> tuple[LoopRecord, int]:
    """Last twelve periods (or 1500 rows) of the longest piece that was used, and its first row in the record."""
    prepared = prepare(diagnosis.record)
    pieces = prepared.require()
    longest = max(range(len(pieces)), key=lambda number: len(pieces[number]))
    piece = pieces[longest]
    period = diagnosis.measured.period
    count = PERIODS * period if np.isfinite(period) else MOST_ROWS
    first = len(piece) - min(max(int(count), FEWEST_ROWS), len(piece))
    return piece.cut(first, len(piece)), prepared.rows[longest][0] + first
