"""What came from a server, kept as Parquet in pieces: each whole or absent, and read as any other record."""

from __future__ import annotations

import threading
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from typing import Any

import polars as pl

from lostmotion.files.writer import refuse_folder, write_bytes

PIECE = 60.0  # s of values in one piece
LARGEST = 200_000  # values in one piece
SCHEMA: dict[str, Any] = {"time": pl.Datetime("us"), "tag": pl.String, "value": pl.Float64, "quality": pl.String}


class Recorder:
    """Writer of pieces: a row for each value, with time in UTC, tag as in FIC101.PV, value and quality.

    Parameters
    ----------
    folder : Path
        Made with the first piece.

    Raises
    ------
    FileAccessError
        It is none, or cannot be made.
    """

    def __init__(self, folder: Path) -> None:
        refuse_folder(folder, ())
        self.folder = folder
        self.pieces = 0
        self._rows: list[tuple[datetime, str, float, str]] = []
        self._last: dict[str, float] = {}  # stamp of each tag: a server tells the last value again to who comes back
        self._lock = threading.Lock()

    def __len__(self) -> int:
        return len(self._rows)

    def add(self, stamp: float, tag: str, value: float, quality: str) -> None:
        """Keep a value until the next piece; the same stamp again is the same value."""
        if self._last.get(tag) == stamp:
            return
        self._last[tag] = stamp
        self._rows.append((datetime.fromtimestamp(stamp, UTC).replace(tzinfo=None), tag, value, quality))

    def write(self) -> Path | None:
        """Write what has come as a piece; None where nothing has."""
        with self._lock:
            rows, self._rows = self._rows, []
            if not rows:
                return None
            stream = BytesIO()
            pl.DataFrame(rows, schema=SCHEMA, orient="row").sort("tag", "time").write_parquet(stream)
            self.pieces += 1
            path = self.folder / f"{datetime.now(UTC):%Y%m%dT%H%M%S%f}-{self.pieces:06d}.parquet"
            return write_bytes(path, stream.getbuffer())
