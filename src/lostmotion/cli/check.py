"""``lostmotion check``."""

from __future__ import annotations

from pathlib import Path

from lostmotion.cli.options import Files, RecordOptions
from lostmotion.cli.output import PrintOptions
from lostmotion.cli.several import each, refuse_tag, tell


def check(
    files: Files,
    *,
    columns: RecordOptions,
    output: PrintOptions,
) -> None:
    """Say what a record holds and what of it can be used: sampling, gaps, flat stretches, saturation, excitation.

    Example: lostmotion check FIC-101.csv --op CO --dt 1

    Several files give one line each, then a table with the worst first; --json gives a list.

    Exit code 1 where a record cannot be identified as it is.
    """
    from lostmotion.records.checked import CheckedRecord, checked_line, checked_table

    refuse_tag(files, columns)

    def work(file: Path) -> CheckedRecord:
        return CheckedRecord.of(columns.read(file))

    found = each(files, work, checked_line, output.json)
    raise tell(found, checked_table, output, lambda record: record.usable)
