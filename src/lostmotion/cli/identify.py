"""``lostmotion identify``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from lostmotion.cli.options import (
    Dt,
    File,
    Force,
    Json,
    Mode,
    NoTime,
    Op,
    OpSpan,
    Pv,
    PvSpan,
    Tag,
    Time,
    refuse_existing,
    show,
)
from lostmotion.errors import ParameterError, Status
from lostmotion.files import read_loop
from lostmotion.identify import identify as identify_model

Orders = Annotated[str, typer.Option("--orders", help='"auto", or na,nb,delay as in 3,2,3.')]
Noise = Annotated[str, typer.Option("--noise", help='"auto", "white", or the order of the AR noise.')]
Kind = Annotated[
    str, typer.Option("--nonlinearity", help='"dead zone", "backlash", "stiction", "saturation", "none" or "auto".')
]
Gain = Annotated[
    float | None,
    typer.Option("--gain", help="Known static gain of the process behind the valve.", show_default=False),
]
Offset = Annotated[str, typer.Option("--offset", help='"auto", "free", or "zero" for records in deviations.')]
Raw = Annotated[bool, typer.Option("--raw", help="Take the record as it is: nothing is left out, holes are an error.")]
Split = Annotated[bool, typer.Option("--split", help="With --raw: cut at gaps and missing samples, fit all pieces.")]
Figure = Annotated[
    Path | None, typer.Option("--figure", help="Write the figure here (png, pdf or svg).", show_default=False)
]
Out = Annotated[
    Path | None, typer.Option("--out", help="Write the result as JSON, for `compensate`.", show_default=False)
]


def identify(
    file: File,
    op: Op = "OP",
    pv: Pv = "PV",
    time: Time = None,
    dt: Dt = None,
    ignore_time: NoTime = False,
    tag: Tag = None,
    op_span: OpSpan = None,
    pv_span: PvSpan = None,
    mode: Mode = None,
    nonlinearity: Kind = "dead zone",
    orders: Orders = "auto",
    noise: Noise = "auto",
    gain: Gain = None,
    offset: Offset = "auto",
    raw: Raw = False,
    split: Split = False,
    figure: Figure = None,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Find the dead zone of the actuator and the process behind it, with intervals.

    Example: lostmotion identify FIC-101.csv --figure fic101.png --out fic101.json

    The record is prepared first: rows that cannot be used are left out, and the report says which and why.

    Exit code 1 where the record does not tell or the fit failed.
    """
    for path in (figure, out):
        refuse_existing(path, force)
    record = read_loop(
        file,
        op=op,
        pv=pv,
        time=False if ignore_time else time,
        dt=dt,
        tag=tag,
        op_span=op_span,
        pv_span=pv_span,
        mode=mode,
    )
    fit = identify_model(
        record.split() if split and raw else record,
        raw=raw,
        nonlinearity=nonlinearity,
        orders=orders if orders == "auto" else read_orders(orders),
        noise=int(noise) if noise.isdigit() else noise,
        gain=gain,
        offset=offset,
    )
    if figure is not None:
        fit.plot().savefig(figure, dpi=120)
    if out is not None:
        fit.save(out, force)
    show(fit.summary(), fit.to_dict(), json)
    raise typer.Exit(0 if fit.status.ok or fit.status is Status.NOT_SEEN else 1)


def read_orders(text: str) -> tuple[int, int, int]:
    """Three numbers from na,nb,delay."""
    try:
        na, nb, delay = (int(part) for part in text.split(","))
    except ValueError as error:
        raise ParameterError.expected("--orders as na,nb,delay", text, "e.g. --orders 3,2,3") from error
    return na, nb, delay
