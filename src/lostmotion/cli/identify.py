"""``lostmotion identify``."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import lostmotion as lm
from lostmotion.cli.next_steps import after_fit
from lostmotion.cli.options import Files, Integrating, RecordOptions, number
from lostmotion.cli.output import Figures, OutputOptions, places
from lostmotion.cli.several import each, refuse_tag, tell
from lostmotion.cli.sources import sources
from lostmotion.errors import ParameterError, Status

if TYPE_CHECKING:
    from lostmotion.identify import HammersteinFit
    from lostmotion.records import LoopRecord

Orders = Annotated[str, typer.Option("--orders", help='"auto", or na,nb,delay as in 3,2,3.')]
Noise = Annotated[str, typer.Option("--noise", help='"auto", "ar", "white", or the order of the AR noise.')]
Kind = Annotated[
    str, typer.Option("--nonlinearity", help='"auto", "dead zone", "backlash", "stiction", "saturation" or "none".')
]
Gain = Annotated[float | None, number("--gain", "Known static gain of the process behind the valve.")]
Offset = Annotated[str, typer.Option("--offset", help='"auto", "free", or "zero" for records in deviations.')]
Raw = Annotated[bool, typer.Option("--raw", help="Take the record as it is: nothing is left out, holes are an error.")]
Split = Annotated[bool, typer.Option("--split", help="With --raw: cut at gaps and missing samples, fit all pieces.")]
Out = Annotated[
    Path | None, number("--out", "Write the result as JSON, for other commands; of several files: a folder.")
]

MOST_ORDER = 100  # a fit of a thousand takes minutes, and no loop has them


@dataclass(frozen=True)
class ModelOptions:
    """What is sought, and what is known of it."""

    nonlinearity: Kind = "auto"
    orders: Orders = "auto"
    noise: Noise = "auto"
    gain: Gain = None
    offset: Offset = "auto"
    integrating: Integrating = None
    raw: Raw = False
    split: Split = False

    def identify(self, record: LoopRecord) -> HammersteinFit:
        """Fit of a record."""
        return lm.identify(
            record.split() if self.split and self.raw else record,
            raw=self.raw,
            nonlinearity=self.nonlinearity,
            orders=self.orders if self.orders == "auto" else read_orders(self.orders),
            noise=read_noise(self.noise),
            gain=self.gain,
            offset=self.offset,
            integrating=self.integrating,
        )


def identify(
    files: Files,
    figure: Figures = None,
    out: Out = None,
    *,
    model: ModelOptions,
    columns: RecordOptions,
    output: OutputOptions,
) -> None:
    """Find the lost motion of the actuator, of whichever kind, and the process behind it, with intervals.

    Example: lostmotion identify FIC-101.csv --figure fic101.png --out fic101.json

    The record is prepared first: rows that cannot be used are left out, and the report says which and why. Several
    files give one line each, then a table with the largest lost motion first; --json gives a list.

    Exit code 1 where a record does not tell, a fit failed, or another kind is likelier than the one asked for.
    """
    from lostmotion.report.fit_table import fit_line, fit_table

    files = sources(files, columns)
    refuse_tag(files, columns)
    figures, outs = places(files, figure, "figures", ".png"), places(files, out, "results", ".json")
    output.refuse(*outs.values(), figures=tuple(figures.values()))

    def work(file: Path) -> HammersteinFit:
        return model.identify(columns.read(file))

    def write(file: Path, fit: HammersteinFit) -> None:
        if file in outs:
            fit.save(outs[file], output.force)
        output.write_figure(figures.get(file), fit)

    found = each(files, work, fit_line, output.json, write=write)
    steps = partial(after_fit, columns=columns, integrating=model.integrating, gain=model.gain, saved=out)
    raise tell(
        found, fit_table, output, lambda fit: fit.status.ok or fit.status is Status.NOT_SEEN, next_steps=steps
    )  # fmt: skip


def read_orders(text: str) -> tuple[int, int, int]:
    """Three numbers from na,nb,delay."""
    try:
        na, nb, delay = (int(part) for part in text.split(","))
    except ValueError as error:
        raise ParameterError.expected("--orders as na,nb,delay", text, "e.g. --orders 3,2,3") from error
    _need_few("--orders", max(na, nb))
    return na, nb, delay


def read_noise(text: str) -> str | int:
    """Order of the noise where it is one, else the word."""
    try:
        order = int(text)
    except ValueError:
        return text
    _need_few("--noise", order)
    return order


def _need_few(option: str, order: int) -> None:
    if order > MOST_ORDER:
        raise ParameterError.expected(f"{option} up to {MOST_ORDER}", order, "give those of a loop, or auto")
