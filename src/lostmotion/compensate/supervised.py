"""Supervised blocks: a compensating block with the handshake of :mod:`lostmotion.kernels.blocks.supervised`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import positive
from lostmotion.arrays import Reals
from lostmotion.compensate import variables as listed
from lostmotion.compensate.block import CompensatorBlock, refuse_setting
from lostmotion.compensate.saved_block import REMEDY, block_of
from lostmotion.compensate.specification import SPECIFICATIONS, Specification
from lostmotion.compensate.supervision_variables import supervision
from lostmotion.compensate.variables import SECTIONS
from lostmotion.errors import DataError, ParameterError
from lostmotion.files.fields import Fields
from lostmotion.kernels.blocks.supervised import backlash, dead_zone, knocker, two_moves

SECONDS = {"timeout": 10.0, "show_scans": 3.0, "accept_scans": 900.0, "least_scans": 300.0}
RANGE, CHANGE = 0.5, 0.25  # of the lost motion that was commissioned
KEY_MODULUS = 524287


@dataclass(frozen=True)
class SupervisedSpecification(Specification):
    """A kind of block with supervision; `first` and `second` are the settings that a supervisor may ask for."""

    first: str = ""
    second: str = ""

    def index(self, name: str) -> int:
        """Index of a variable in its array."""
        for section in SECTIONS:
            names = [variable.name for variable in self.section(section)]
            if name in names:
                return names.index(name)
        raise ParameterError.expected("a variable of the block", name, "see `variables`")

    def run(self, p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
        """All scans of `inputs` into `outputs`."""
        with np.errstate(all="ignore"):
            self.module.run(p, s, inputs, outputs)


def _specification(
    kind: str, module: ModuleType, own: tuple[listed.Variable, ...], first: str, second: str = ""
) -> SupervisedSpecification:
    plain = SPECIFICATIONS[kind]
    meaning = {variable.name: variable.meaning for variable in plain.section("parameter")}
    every = (*listed.COMMON, *own, *supervision(meaning[first], meaning.get(second, "none in this kind, ask for 0")))
    order = [variable for section in SECTIONS for variable in every if variable.section == section]
    return SupervisedSpecification(
        plain.title, plain.number, module, tuple(order), plain.source, first.lower(), second.lower()
    )


SUPERVISED: dict[str, SupervisedSpecification] = {
    made.title: made
    for made in (
        _specification("dead zone", dead_zone, listed.DEAD_ZONE, "LEFT_BREAK", "RIGHT_BREAK"),
        _specification("backlash", backlash, listed.BACKLASH, "LEAD_UP", "LEAD_DOWN"),
        _specification("stiction knocker", knocker, listed.KNOCKER, "AMPLITUDE"),
        _specification("stiction two moves", two_moves, listed.TWO_MOVES, "OVERSHOOT", "STAND"),
    )
}


@dataclass(frozen=True)
class SupervisedBlock:
    """A block that compensates only with what a supervisor has asked for and an operator has accepted.

    Parameters
    ----------
    block : CompensatorBlock
        The settings that are commissioned: widths about which a supervisor may ask, and the largest factor.
    values : tuple of float
        Settings of the supervision in the order of the specification; :meth:`of` takes them by name.

    Examples
    --------
    >>> plain = CompensatorBlock.of("backlash", 0.5, {"lead_up": 0.5, "lead_down": 0.5, "band": 0.1})
    >>> SupervisedBlock.of(plain, timeout=20).settings["timeout"]
    20.0
    """

    block: CompensatorBlock
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        named = self.specification.section("parameter")[len(self.block.values) :]
        if len(self.values) != len(named):
            raise ParameterError.expected(f"{len(named)} values", len(self.values), "use SupervisedBlock.of()")
        for variable, value in zip(named, self.values, strict=True):
            least = 1.0 if variable.name in ("TIMEOUT", "SHOW_SCANS", "ACCEPT_SCANS") else 0.0
            whole = variable.kind != "int" or value == math.floor(value)
            if not (math.isfinite(value) and value >= least and whole):
                raise ParameterError.expected(f"{variable.name.lower()} of {least:g} or more", value, "give another")
            refuse_setting(variable.name.lower(), value)
        positive("resolution", self.settings["resolution"])
        key = self.settings["block_key"]
        if key >= KEY_MODULUS:
            raise ParameterError.expected(f"a block_key below {KEY_MODULUS}", key, "take another")

    @classmethod
    def of(cls, block: CompensatorBlock, **settings: float) -> Self:
        """Supervised block; times from the scan time and ranges from the widths, where they are not given."""
        names = [v.name.lower() for v in SUPERVISED[block.kind].section("parameter")[len(block.values) :]]
        unknown = sorted(set(settings) - set(names))
        if unknown:
            raise ParameterError.expected(f"settings out of {names}", unknown, "see the parameter list")
        known = {**_usual(block), **settings}
        return cls(block, tuple(float(known[name]) for name in names))

    @property
    def specification(self) -> SupervisedSpecification:
        """Kernel and variables."""
        return SUPERVISED[self.block.kind]

    @property
    def kind(self) -> str:
        """Kind of the block."""
        return self.block.kind

    @property
    def scan_time(self) -> float:
        """Seconds between two scans."""
        return self.block.scan_time

    @property
    def notes(self) -> tuple[str, ...]:
        """How the settings were found."""
        return self.block.notes

    @property
    def accepted(self) -> str:
        """Reason for which a closed gate was passed."""
        return self.block.accepted

    @property
    def settings(self) -> dict[str, float]:
        """Every setting by name."""
        names = [variable.name.lower() for variable in self.specification.section("parameter")]
        return dict(zip(names, (*self.block.values, *self.values), strict=True))

    def parameters(self, dtype: npt.DTypeLike = np.float64) -> Reals:
        """Parameter array of the kernel."""
        return np.array((*self.block.values, *self.values), dtype=dtype)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        names = list(self.settings)[len(self.block.values) :]
        return {**self.block.to_dict(), "supervision": dict(zip(names, self.values, strict=True))}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`.

        Raises
        ------
        DataError, ParameterError
            Something is missing, of another type, unknown or outside its range.
        """
        block = block_of(data)
        given = Fields(data.get("supervision", {}), "a supervised block", REMEDY, "supervision.")
        known = {variable.name.lower() for variable in SUPERVISED[block.kind].section("parameter")}
        unknown = [name for name in given.names if name not in known]
        if unknown:
            raise DataError.expected("settings of the supervision in a supervised block", unknown[:3], REMEDY)
        return cls.of(block, **{name: given.number(name) for name in given.names})


def _usual(block: CompensatorBlock) -> dict[str, float]:
    """Settings of the supervision that follow from the block."""
    specification, settings = SUPERVISED[block.kind], block.settings
    first, second = settings[specification.first], settings.get(specification.second, 0.0)
    size = abs(second - first) if block.kind == "dead zone" else max(abs(first), abs(second))
    scans = {name: float(max(math.ceil(seconds / block.scan_time), 2)) for name, seconds in SECONDS.items()}
    ranges = {"first_range": RANGE * size, "second_range": RANGE * size if specification.second else 0.0}
    return {**scans, **ranges, "most_change": CHANGE * size, "block_key": 0.0, "resolution": 0.001}
