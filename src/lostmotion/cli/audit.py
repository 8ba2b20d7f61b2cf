"""``lostmotion audit``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.closed_output import echo, echo_data
from lostmotion.cli.options import number
from lostmotion.cli.output import Figure, OutputOptions
from lostmotion.cli.progress import progress
from lostmotion.cli.sources import as_path
from lostmotion.errors import ParameterError
from lostmotion.files.paths import is_file, is_other

if TYPE_CHECKING:
    from lostmotion.audit.audit_run import AuditRun
    from lostmotion.audit.plant_view import PlantView
    from lostmotion.audit.runner.run import Progress

STORE = "plant.db"

Sources = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="SOURCE",
        help="Folder, pattern or files with the records of the loops, or the URL of a database.",
        show_default=False,
        parser=as_path,
    ),
]
Loops = Annotated[Path | None, number("--loops", "Loop list (see --propose); default: what can be inferred.")]
Kept = Annotated[str, typer.Option("--store", help="Where results are kept: a file, or postgresql://user@host/plant.")]
Engine = Annotated[str, typer.Option("--engine", help="processes, inline, dask, tcp://HOST:PORT or tls://HOST:PORT.")]
Workers = Annotated[int | None, number("--workers", "Processes; default: one a processor.")]
Insecure = Annotated[bool, typer.Option("--insecure", help="Allow a tcp:// scheduler on another machine.")]
Window = Annotated[str | None, number("--window", "Length of an assessment, as 2h or 1d; default: all data of a loop.")]
Since = Annotated[str | None, number("--since", "Only what was recorded from then on, as 2026-03-01 (UTC).")]
Until = Annotated[str | None, number("--until", "Only what was recorded before.")]
Tolerance = Annotated[float, number("--tolerance", "Lost motion that does not matter, as a share of the span of OP.")]
Minutes = Annotated[float | None, number("--cpu-minutes", "Processor time of all diagnoses, most valuable first.")]
LoopMinutes = Annotated[float, number("--loop-minutes", "Longest time for one loop; it has failed if it takes more.")]
ScreenOnly = Annotated[bool, typer.Option("--screen-only", help="Diagnose nothing.")]
Report = Annotated[Path | None, number("--report", "Write the report of the plant as one HTML file.")]
Pages = Annotated[Path | None, number("--report-loops", "Write an HTML file for each loop worth it into this folder.")]
Table = Annotated[Path | None, number("--table", "Write the table of all loops (csv or parquet).")]
Show = Annotated[bool, typer.Option("--show", help="Show the last run of the store (SOURCE), without the data.")]
Propose = Annotated[bool, typer.Option("--propose", help="Print a loop list of the source, to be corrected.")]
Upgrade = Annotated[bool, typer.Option("--upgrade", help="Bring an older store (SOURCE) to this version.")]
Dt = Annotated[float | None, number("--dt", "Sampling time in seconds; default: from the time columns.")]


@dataclass(frozen=True)
class HowOptions:
    """On what an audit runs."""

    engine: Engine = "processes"
    workers: Workers = None
    insecure: Insecure = False


@dataclass(frozen=True)
class WhatOptions:
    """What is looked at."""

    window: Window = None
    since: Since = None
    until: Until = None
    tolerance: Tolerance = 0.01
    cpu_minutes: Minutes = None
    loop_minutes: LoopMinutes = 30.0
    screen_only: ScreenOnly = False


@dataclass(frozen=True)
class ReportOptions:
    """What is written of the result."""

    report: Report = None
    report_loops: Pages = None
    table: Table = None
    figure: Figure = None


def audit(
    sources: Sources = None,
    loops: Loops = None,
    store: Kept = STORE,
    dt: Dt = None,
    show: Show = False,
    propose: Propose = False,
    upgrade: Upgrade = False,
    *,
    how: HowOptions,
    what: WhatOptions,
    written: ReportOptions,
    output: OutputOptions,
) -> None:
    """Look at all loops of a plant: which valves need a hand, how sure that is, what swings with what, what is new.

    Example: lostmotion audit plant --loops plant/loops.csv --report plant.html

    Every loop is screened, those that can tell are diagnosed, the most valuable first; results are kept in the store,
    and an audit that was stopped goes on where it was. `audit --show plant.db` shows the last run, `audit --propose
    FOLDER > loops.csv` writes a loop list to correct.

    Exit code 0 where nothing was found and all was read; 1 for a finding (a valve at fault, a sensor to look at, a loop
    to retune, a valve that never rests) or a failure.
    """
    given = [str(one) for one in sources or []]
    if not given:
        raise typer.BadParameter("give the folder with the records", param_hint="SOURCE")
    if upgrade:
        _upgrade(given)
        return
    if propose:
        _propose(given, loops)
        return
    _refuse(written, output)
    found = _shown(given) if show else _audited(given, loops, store, dt, how, what)
    _write(found, written, output)
    output.show(found.summary(), found.to_dict() if output.json else {})
    raise typer.Exit(1 if found.findings or found.failures else 0)


def _audited(
    given: list[str], loops: Path | None, store: str, dt: float | None, how: HowOptions, what: WhatOptions
) -> AuditRun:
    reading: dict[str, Any] = {} if dt is None else {"dt": dt}
    source: Any = given if len(given) > 1 else given[0]
    try:
        return lm.audit(source, store, loops=loops, progress=_progress, **vars(how), **vars(what), **reading)
    except KeyboardInterrupt:
        progress("")
        echo(f"stopped; what is done is kept in {store}: the same command goes on from there", err=True)
        raise typer.Exit(1) from None


def _shown(given: list[str]) -> AuditRun:
    from lostmotion.audit.audit_run import AuditRun

    if len(given) > 1:
        raise typer.BadParameter("give one store", param_hint="SOURCE")
    return AuditRun.of(given[0])


def _propose(given: list[str], loops: Path | None) -> None:
    from lostmotion.cli.propose import propose

    if loops is not None:
        raise typer.BadParameter("a list is proposed; leave --loops out", param_hint="--loops")
    echo_data(propose(given if len(given) > 1 else given[0]))


def _upgrade(given: list[str]) -> None:
    from lostmotion.store.upgrade import upgrade

    for one in given:
        before, after = upgrade(one)
        echo(f"{one}: version {before}, as this package" if before == after else f"{one}: {before} -> {after}")


def _refuse(written: ReportOptions, output: OutputOptions) -> None:
    """Refuse what could not be written before hours of work."""
    output.refuse(written.report, figures=(written.figure,), table=written.table)
    if written.report_loops is not None and (is_file(written.report_loops) or is_other(written.report_loops)):
        raise ParameterError.expected("a folder for --report-loops", written.report_loops, "give another name")


def _write(found: AuditRun, written: ReportOptions, output: OutputOptions) -> None:
    output.write_figure(written.figure, found)
    if written.table is not None:
        from lostmotion.files.write import write_table

        write_table(written.table, found.table(), output.force)
    if written.report is None and written.report_loops is None:
        return
    from lostmotion.report.plant import plant_report

    if written.report is not None:
        output.write_text(written.report, plant_report(found.view))
    if written.report_loops is not None:
        _write_pages(found.view, written.report_loops, output)


def _write_pages(view: PlantView, folder: Path, output: OutputOptions) -> None:
    from lostmotion.files.tag_file import tag_file
    from lostmotion.files.writer import write_folder
    from lostmotion.report.plant import loop_report

    pages: dict[str, bytes] = {}
    for row in view.leading:
        if row.priority:
            pages[tag_file(row.tag, ".html")] = loop_report(view.loop_view(row.tag)).encode()
    write_folder(folder, pages, output.force)


def _progress(now: Progress) -> None:
    left = "" if now.seconds_left is None else f", {_time(now.seconds_left)} left"
    rate = "" if now.rate is None else f", {now.rate:.3g}/s"
    words = {"screen": "screened", "assess": "assessed", "rank": "ranking"}[now.stage]
    progress(f"{words} {now.done} of {now.total}{rate}{left}" if now.stage != "rank" else "ranking ..")


def _time(seconds: float) -> str:
    """Short.

    Examples
    --------
    >>> _time(42.3), _time(200), _time(9000)
    ('42 s', '3 min', '2.5 h')
    """
    if seconds < 120.0:
        return f"{seconds:.0f} s"
    return f"{seconds / 60.0:.0f} min" if seconds < 7200.0 else f"{seconds / 3600.0:.2g} h"
