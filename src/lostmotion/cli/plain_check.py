"""What check says of one record: what was read, what was repaired, what to know, and what to type next."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from lostmotion.cli.next_steps import typed
from lostmotion.cli.options import RecordOptions
from lostmotion.cli.several import modes_as_options
from lostmotion.cli.sources import words_of
from lostmotion.cli.wording import as_options
from lostmotion.printable import shell_line

if TYPE_CHECKING:
    from lostmotion.records import LoopRecord
    from lostmotion.records.checked import CheckedRecord
    from lostmotion.records.signal_facts import SignalFacts

LEVELS = {"error": "Not usable", "warning": "Beware", "info": "Good to know"}


def plain(found: CheckedRecord, record: LoopRecord, file: Path, columns: RecordOptions) -> str:
    """Several lines for people; the last is the next command, complete with the options that were given."""
    report, prepared = found.report, found.prepared
    lines = [_held(record, file), *(_moves(facts) for facts in (report.op, report.pv) if facts is not None)]
    if report.loop is not None:
        lines.append(f"Loop: {report.loop.mode}; OP turned round {report.loop.op_reversals} times.")
    lines += [f"Read so: {as_options(note)}" for note in report.notes]
    for finding in report.findings:
        said = " ".join(part for part in (finding.what, finding.why, finding.remedy) if part)
        lines.append(f"{LEVELS[finding.level]}: {as_options(modes_as_options(said))}")
    lines += [as_options(modes_as_options(line.strip())) for line in prepared.summary().splitlines()]
    lines.append("Usable." if found.usable else "Not usable for identification.")
    lines.append(f"Next: {next_command(found, file, columns)}")
    return "\n".join(lines)


def next_command(found: CheckedRecord, file: Path, columns: RecordOptions) -> str:
    """What to do after a check: the command of the diagnosis, or a better export.

    Parameters
    ----------
    found : CheckedRecord
        What was found.
    file, columns : Path and RecordOptions
        The record as it was read.
    """
    if found.usable:
        return f"lostmotion {shell_line(['diagnose', *words_of(file), *typed(columns)])}"
    return "export the record again, longer or without compression, and check that file"


def _held(record: LoopRecord, file: Path) -> str:
    signals = [name for name in ("OP", "PV", "SP") if getattr(record, name.lower()) is not None]
    signals += ["the position"] if record.position is not None else []
    listed = " and ".join([", ".join(signals[:-1]), signals[-1]])
    kind = f", a {record.loop_type} loop by its tag" if record.loop_type else ""
    gaps = f"; time is missing in {len(record.gaps)} places" if record.gaps else ""
    missing = int(record.missing.sum())
    lost = f"; {missing} rows miss OP or PV" if missing else ""
    return (
        f"{_shown(file)} loop {record.tag!r}{kind}: {len(record)} samples of {listed}, one every {record.dt:g} s, "
        f"{duration(len(record) * record.dt)} in all{gaps}{lost}."
    )


def _shown(file: Path) -> str:
    """Short name, and that it holds something: of files together the first and how many more."""
    words = words_of(file)
    name = Path(words[0]).name or words[0]
    return f"{name} and {len(words) - 1} more hold" if len(words) > 1 else f"{name} holds"


def _moves(facts: SignalFacts) -> str:
    share = "" if facts.amplitude_of_span is None else f" ({100 * facts.amplitude_of_span:.3g} % of span)"
    return (
        f"{facts.name} goes from {facts.low:.5g} to {facts.high:.5g}, mostly over {facts.amplitude:.3g}{share}; "
        f"its smallest step is {facts.step:.3g}."
    )


def duration(seconds: float) -> str:
    """Time in words.

    Examples
    --------
    >>> duration(7510.0), duration(604800.0), duration(12.5)
    ('2 h 5 min', '7 days', '12.5 s')
    """
    days, rest = divmod(round(seconds), 86400)
    hours, rest = divmod(rest, 3600)
    minutes = rest // 60
    parts = [f"{days} day{'s' if days > 1 else ''}"] if days else []
    parts += [f"{hours} h"] if hours else []
    parts += [f"{minutes} min"] if minutes and not days else []
    return " ".join(parts) or f"{seconds:g} s"
