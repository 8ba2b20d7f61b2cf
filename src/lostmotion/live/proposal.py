"""What a supervisor may propose: the widths of a block that a study of the simulated loop has passed."""

from __future__ import annotations

from dataclasses import dataclass

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.request import LARGEST
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import GateError
from lostmotion.evaluate import CompensationStudy

WORTH_IT = ("compensate", "compensate and retune")


@dataclass(frozen=True)
class Proposal:
    """Factor, first and second width in whole numbers of the block's resolution, and the study that passed them."""

    factor: int
    first: int
    second: int
    study: str

    def to_dict(self) -> dict[str, int]:
        """The numbers by name, as the log shows them."""
        return {"factor": self.factor, "first": self.first, "second": self.second}


def proposal(block: SupervisedBlock, study: CompensationStudy) -> Proposal:
    """What `study` allows to ask of `block`.

    Parameters
    ----------
    block : SupervisedBlock
        As it was commissioned: what it is in the PLC.
    study : CompensationStudy
        Of that block with other widths; all its other settings must be those of the PLC.

    Raises
    ------
    GateError
        The study is not safe, recommends something else, or tried another block.
    """
    if not study.safe or study.recommendation not in WORTH_IT:
        got = f"{'safe' if study.safe else 'not safe'}, {study.recommendation}"
        raise GateError.expected(f"a study that is safe and says {' or '.join(WORTH_IT)}", got, "nothing is proposed")
    specification = block.specification
    asked = study.block.settings
    widths = {name: asked[name] for name in ("factor", specification.first, specification.second) if name in asked}
    _refuse_another(block.block, study.block, set(widths))
    unit = block.settings["resolution"]
    factor, first, second = (
        _units(widths.get(name, 0.0), unit) for name in ("factor", specification.first, specification.second)
    )
    said = f"{study.recommendation}: {study.described}"
    return Proposal(factor, first, second, said)


def _refuse_another(commissioned: CompensatorBlock, tried: CompensatorBlock, free: set[str]) -> None:
    """Raise where the study tried what the PLC does not hold."""
    other = ["kind"]
    if tried.kind == commissioned.kind:
        there, here = tried.settings, commissioned.settings
        other = [name for name in here if name not in free and there[name] != here[name]]
    if tried.scan_time != commissioned.scan_time:
        other.append("scan_time")
    if other:
        remedy = "simulate the block that was commissioned, with these widths: block.with_settings(..)"
        raise GateError.expected(f"a study of the block in the PLC but for {sorted(free)}", f"other {other}", remedy)


def _units(value: float, unit: float) -> int:
    """Whole units, the nearest."""
    number = round(value / unit)
    if abs(number) > LARGEST:
        raise GateError.expected(f"a value within {LARGEST * unit:g}", value, "take a coarser resolution")
    return number
