"""The page that goes with the file: wiring, first enabling, what to watch, how to back out."""

from __future__ import annotations

import math

from lostmotion.export import structured_text
from lostmotion.export.frame import declare, render
from lostmotion.export.source import Source

IMPORTS = {
    "st": "Paste the file into a new function block (CODESYS, TwinCAT, OpenPLC: declaration and body where the tool "
    "keeps them apart).",
    "plcopen": "CODESYS: Project, Import PLCopenXML. Other tools that read TC6 v2.01: their import.",
    "tcpou": "TwinCAT: right-click POUs, Add, Existing Item. If floating point exceptions are on for the task, a NaN "
    "at the input stops it: take them off.",
    "scl": "TIA Portal: External source files, Add new external file, then Generate blocks from source.",
    "l5x": "Studio 5000: right-click Add-On Instructions, Import Add-On Instruction. LREAL needs a controller that "
    "has it.",
    "c": "Add both files to the project; keep IEEE arithmetic (no -ffast-math). Set the inputs, call the step function "
    "once in each scan, read the outputs.",
}


def page(source: Source, target: str, files: list[str]) -> str:
    """Markdown."""
    declared = declare(source, source.tree, structured_text.types(source.real))
    values = source.values
    cap, ramp = values["cap"], values["ramp_step"]
    scans = math.ceil(cap / ramp) if ramp > 0 else None
    return render(
        "commissioning.md.j2",
        source=source,
        block=source.block,
        header=source.header(f"see the first lines of {files[0]}.")[:7],
        files=files,
        how=IMPORTS[target],
        rows=declared.rows,
        values=values,
        out_seconds=None if scans is None else scans * source.block.scan_time,
    )
