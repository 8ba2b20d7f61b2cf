"""The page that goes with the file: wiring, first enabling, what to watch, how to back out."""

from __future__ import annotations

import math

from lostmotion.compensate.supervised import SupervisedSpecification
from lostmotion.compensate.supervision_variables import REASONS, REFUSALS, listed
from lostmotion.export import outside
from lostmotion.export.dialects import Dialect, structured_text
from lostmotion.export.frame import declare, render
from lostmotion.export.source import Source


def page(source: Source, dialect: Dialect, files: list[str]) -> str:
    """Markdown."""
    declared = declare(source, source.tree, structured_text.types(source.real))
    values = source.values
    cap, ramp = values["cap"], values["ramp_step"]
    scans = math.ceil(cap / ramp) if ramp > 0 else None
    specification = source.specification
    names = (
        (specification.first, specification.second) if isinstance(specification, SupervisedSpecification) else ("", "")
    )
    return render(
        "commissioning.md.j2",
        source=source,
        block=source.block,
        header=source.header(f"see the first lines of {files[0]}.", outside.markdown)[: 8 if source.supervised else 7],
        files=files,
        how=dialect.how_to_import,
        rows=declared.rows,
        values=values,
        first=names[0],
        second=names[1],
        refusals=listed(REFUSALS),
        reasons=listed(REASONS),
        out_seconds=None if scans is None else scans * source.block.scan_time,
    )
