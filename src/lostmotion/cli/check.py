"""``lostmotion check``."""

from __future__ import annotations

import typer

from lostmotion.cli.options import Dt, File, Json, Mode, NoTime, Op, OpSpan, Pv, PvSpan, Tag, Time, show
from lostmotion.files import read_loop
from lostmotion.records import check as check_record
from lostmotion.records import prepare


def check(
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
    json: Json = False,
) -> None:
    """Say what a record holds and what of it can be used: sampling, gaps, flat stretches, saturation, excitation.

    Example: lostmotion check FIC-101.csv --op CO --dt 1

    Exit code 1 where the record cannot be identified as it is.
    """
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
    report, prepared = check_record(record), prepare(record)
    show(f"{report.summary()}\n{prepared.summary()}", report.to_dict() | {"prepared": prepared.to_dict()}, json)
    raise typer.Exit(0 if report.usable and prepared.usable else 1)
