"""Options that several commands share: the file, its columns and what is known of the record."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from lostmotion.cli.progress import read_with_progress
from lostmotion.cli.sources import as_path, read_as

if TYPE_CHECKING:
    from lostmotion.records import LoopRecord


def number(flag: str, help_: str) -> Any:
    """Option without a default."""
    return typer.Option(flag, help=help_, show_default=False)


File = Annotated[
    Path,
    typer.Argument(
        help="CSV, text, Parquet or MAT file with the record of one loop, or a folder of files of one tag each.",
        show_default=False,
        parser=as_path,
    ),
]
Files = Annotated[
    list[Path],
    typer.Argument(
        metavar="FILE",
        help="Records (CSV, text, Parquet, MAT): a file for each loop, a file or a folder with several loops, or a "
        "file for each tag (FIC101_OP.csv FIC101_PV.csv); or the URL of a database, with --query.",
        show_default=False,
        parser=as_path,
    ),
]
Integrating = Annotated[
    bool | None,
    number(
        "--integrating/--self-regulating",
        "Whether the process integrates (a level); default: a flow does not, else as identified.",
    ),
]
Op = Annotated[str, typer.Option("--op", help="Column of the controller output (also found as CO, MV, OUT ..).")]
Pv = Annotated[str, typer.Option("--pv", help="Column of the measurement.")]
Sp = Annotated[str, typer.Option("--sp", help="Column of the set point; not needed.")]
Dt = Annotated[float | None, number("--dt", "Sampling time in seconds; default: from the time column.")]
Time = Annotated[str | None, number("--time", "Time column, if it has an unusual name.")]
NoTime = Annotated[bool, typer.Option("--ignore-time", help="Rows are equally spaced in truth; needs --dt.")]
Tag = Annotated[str | None, number("--tag", "Name of the loop; default: name of the file.")]
OpSpan = Annotated[
    tuple[float, float] | None,
    number("--op-span", "Limits of OP in its units, for results in % of span, e.g. 0 100."),
]
PvSpan = Annotated[
    tuple[float, float] | None,
    number("--pv-span", "Range of the transmitter in units of PV, e.g. 0 250."),
]
Loop = Annotated[str | None, number("--loop", "Tag of the loop, where a file holds several: FIC102.")]
Query = Annotated[str | None, number("--query", "SQL that gives the rows; FILE is then the URL of a database.")]
Uncertain = Annotated[
    Literal["keep", "bad"],
    typer.Option("--uncertain", help="Values of uncertain quality: keep them, or let them be missing as bad ones are."),
]
NoQuality = Annotated[bool, typer.Option("--ignore-quality", help="Take all values, whatever their quality.")]
Mode = Annotated[str | None, number("--mode", "Column with the mode of the controller.")]
Automatic = Annotated[
    list[str] | None,
    number("--auto-value", "What the mode column holds in automatic; several times for several."),
]
Manual = Annotated[
    list[str] | None,
    number("--manual-value", "What the mode column holds in manual; several times for several."),
]


@dataclass(frozen=True)
class ColumnOptions:
    """Where OP, PV and the time stand in a file."""

    op: Op = "OP"
    pv: Pv = "PV"
    time: Time = None
    dt: Dt = None
    ignore_time: NoTime = False

    @property
    def time_column(self) -> str | Literal[False] | None:
        """As the readers want it: False where the times are to be ignored."""
        return False if self.ignore_time else self.time

    def read(self, path: Any, **other: Any) -> LoopRecord:
        """Record of a file; `other` are further arguments of :func:`lostmotion.read_loop`."""
        known = asdict(self) | {"time": self.time_column}
        for name in ("ignore_time", "ignore_quality", "auto_value", "manual_value"):
            known.pop(name, None)
        return read_with_progress(path, **known | other)


@dataclass(frozen=True)
class RecordOptions(ColumnOptions):
    """Where the record of a loop stands in a file, and what is known of the loop."""

    sp: Sp = "SP"
    tag: Tag = None
    op_span: OpSpan = None
    pv_span: PvSpan = None
    mode: Mode = None
    loop: Loop = None
    query: Query = None
    uncertain: Uncertain = "keep"
    ignore_quality: NoQuality = False
    auto_value: Automatic = None
    manual_value: Manual = None

    def read(self, path: Path, **other: Any) -> LoopRecord:
        """Record of a file, or of what a Source stands for; `other` are further arguments of read_loop."""
        quality = False if self.ignore_quality else None
        known = {"automatic": self.auto_value, "manual": self.manual_value, "quality": quality} | other
        return read_as(path, partial(super().read, **known), self)
