"""``lostmotion diagnose``."""

from __future__ import annotations

from dataclasses import replace
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import lostmotion as lm
from lostmotion.cli.next_steps import after_diagnosis
from lostmotion.cli.options import Files, Integrating, RecordOptions, number
from lostmotion.cli.output import Figures, OutputOptions, places
from lostmotion.cli.progress import progress
from lostmotion.cli.several import each, refuse_tag, tell
from lostmotion.cli.sources import sources
from lostmotion.cli.wording import as_options

if TYPE_CHECKING:
    from lostmotion.diagnose import Diagnosis


class LoopType(StrEnum):
    """What PV measures, as ``diagnose`` knows it."""

    FLOW = "flow"
    PRESSURE = "pressure"
    TEMPERATURE = "temperature"
    LEVEL = "level"
    ANALYSER = "analyser"
    CONCENTRATION = "concentration"
    OTHER = "other"


Type = Annotated[
    LoopType | None,
    number("--loop-type", "What PV measures: the class of performance depends on it; a flow does not integrate."),
]
Tolerance = Annotated[
    float, number("--tolerance", "Lost motion that does not matter, as a share of the span of OP: 0.01 is 1 %.")
]
SameLoop = Annotated[
    bool, typer.Option("--same-loop", help="The files are records of one loop: one verdict from all together.")
]
Report = Annotated[
    Path | None,
    number("--report", "Write a page about the loop here (html, one file, printable); of several files: a folder."),
]
Out = Annotated[Path | None, number("--out", "Write the result as JSON; of several files: a list.")]


def diagnose(
    files: Files,
    integrating: Integrating = None,
    loop_type: Type = None,
    tolerance: Tolerance = 0.01,
    same_loop: SameLoop = False,
    figure: Figures = None,
    report: Report = None,
    out: Out = None,
    *,
    columns: RecordOptions,
    output: OutputOptions,
) -> None:
    """Say what is wrong with a loop: actuator, tuning, disturbance or sensor, how sure that is, and what to do.

    Example: lostmotion diagnose FIC-101.csv --loop-type flow --figure fic101.png

    Example: lostmotion diagnose FIC-101.csv --report fic101.html

    Several files, or the loops of one, give one line each as they are done, then a table with the worst first. With
    --same-loop they are records of one valve: what they say is added up, in the order given. Long records are read by
    their windows.

    Exit code 0 where nothing is wrong with the actuator; 1 for a finding, a record that does not tell, or a failure.
    """
    from lostmotion.report import diagnosis_line, diagnosis_table

    files = sources(files, columns, every_loop=not same_loop)
    if same_loop:
        raise _together(files, integrating, loop_type, tolerance, figure, report, out, columns, output)
    refuse_tag(files, columns)
    figures = places(files, figure, "figures", ".png")
    reports = places(files, report, "reports", ".html")
    output.refuse(out, *reports.values(), figures=tuple(figures.values()))

    def work(file: Path) -> Diagnosis:
        kind = None if loop_type is None else loop_type.value
        record = columns.read(file)
        return lm.diagnose(record, integrating=integrating, loop_type=kind, tolerance=tolerance, progress=progress)

    def write(file: Path, found: Diagnosis) -> None:
        output.write_figure(figures.get(file), found)
        _write_report(reports.get(file), found, str(file), output)

    found = each(files, work, diagnosis_line, output.json, output.keeper(out), write)
    known = {"loop_type": None if loop_type is None else loop_type.value, "integrating": integrating}
    steps = partial(after_diagnosis, columns=columns, known=known)
    raise tell(found, diagnosis_table, output, lambda one: one.cleared, named=True, next_steps=steps)


def _together(
    files: list[Path],
    integrating: bool | None,
    loop_type: LoopType | None,
    tolerance: float,
    figure: Path | None,
    report: Path | None,
    out: Path | None,
    columns: RecordOptions,
    output: OutputOptions,
) -> typer.Exit:
    """One verdict from the files of one loop, and the exit code that it has."""
    output.refuse(out, report, figures=(figure,))
    records = [columns.read(file) for file in files]
    if len(files) > 1:  # each by its name
        records = [replace(record, tag=file.stem) for record, file in zip(records, files, strict=True)]
    kind = None if loop_type is None else loop_type.value
    found = lm.diagnose(records, integrating=integrating, loop_type=kind, tolerance=tolerance, progress=progress)
    data = {"files": [str(file) for file in files], **found.to_dict()}
    output.show(as_options(found.summary()), data)
    output.write_json(out, data)
    output.write_figure(figure, found)
    _write_report(report, found, str(files[0]), output)
    return typer.Exit(0 if found.cleared else 1)


def _write_report(path: Path | None, found: Diagnosis, source: str, output: OutputOptions) -> None:
    """Write the page of a loop, where it is wanted."""
    if path is not None:
        from lostmotion.report.plant.of_diagnosis import diagnosis_report

        output.write_text(path, diagnosis_report(found, source))
