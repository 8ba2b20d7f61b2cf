"""``lostmotion check``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from lostmotion.cli.listed import listed_loops
from lostmotion.cli.options import Files, RecordOptions
from lostmotion.cli.output import PrintOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.several import each, refuse_tag, tell
from lostmotion.cli.sources import sources

if TYPE_CHECKING:
    from lostmotion.records import LoopRecord
    from lostmotion.records.checked import CheckedRecord


def check(
    files: Files,
    *,
    columns: RecordOptions,
    output: PrintOptions,
) -> None:
    """Say what a record holds and what of it can be used: sampling, gaps, flat stretches, saturation, excitation.

    Example: lostmotion check FIC-101.csv --op CO --dt 1

    Several files give one line each, then a table with the worst first; --json gives a list. Files of one tag each, or
    a folder of them, are one record. Of a file with several loops it lists these.

    Exit code 1 where a record cannot be identified as it is, or a loop is to be named.
    """
    from lostmotion.records import prepare
    from lostmotion.records.checked import CheckedRecord, checked_line, checked_table
    from lostmotion.records.checks import check as described

    files = sources(files, columns)
    if len(files) == 1 and (listed := listed_loops(files[0], columns)) is not None:
        output.show(listed.summary(), listed.to_dict())
        raise typer.Exit(1)
    refuse_tag(files, columns)

    def work(file: Path) -> Told:
        record = columns.read(file)
        progress(f"checking {len(record)} rows ..")
        report = described(record)
        progress(f"finding what can be used of {len(record)} rows ..")
        return Told(CheckedRecord(report, prepare(record)), record, file, columns)

    def line(name: str, told: Told | None, error: str | None) -> str:
        return checked_line(name, None if told is None else told.found, error)

    found = each(files, work, line, output.json)
    raise tell(
        found,
        lambda rows: checked_table([(name, None if told is None else told.found) for name, told in rows]),
        output,
        lambda told: told.found.usable,
    )


@dataclass(frozen=True, eq=False)
class Told:
    """What was found in a record, with the file and options it was read by."""

    found: CheckedRecord
    record: LoopRecord
    file: Path
    columns: RecordOptions

    def summary(self) -> str:
        """In plain words, with the next command at the end."""
        from lostmotion.cli.plain_check import plain

        return plain(self.found, self.record, self.file, self.columns)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        return self.found.to_dict()
