"""Options of the commands on the way to the valve: a reason for a closed gate, and a diagnosis that must agree."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from lostmotion.cli.options import number

Accept = Annotated[
    str | None,
    number("--accept", "Reason to go on past a closed gate; it stands in everything that is written."),
]
Says = Annotated[Path | None, number("--diagnosis", "Result of `diagnose --out`: it must name the kind of the fit.")]


@dataclass(frozen=True)
class GateOptions:
    """What opens a gate, or keeps it closed."""

    accept: Accept = None
    diagnosis: Says = None

    def given(self) -> dict[str, Any]:
        """Arguments of the library."""
        from lostmotion.files.results import read_json

        said = None
        if self.diagnosis is not None:
            said = read_json(self.diagnosis, "a diagnosis", "use what diagnose --out wrote")
        return {"accept": self.accept, "diagnosis": said}
