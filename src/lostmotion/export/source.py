"""What is exported: a block, its settings, and what the header of every file says about them."""

from __future__ import annotations

import datetime as dt
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.compensate import CompensatorBlock, Specification
from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import ParameterError
from lostmotion.export.names import block_name
from lostmotion.export.outside import anywhere
from lostmotion.export.translate import translate
from lostmotion.export.tree import Block, Name

TYPES: dict[str, npt.DTypeLike] = {"lreal": np.float64, "real": np.float32}
LARGEST_INT = 2.0**31
UNKNOWN = "not given"
SUPERVISED = "Supervised: compensates only with what was asked for, checked, shown and accepted; else passive."


@dataclass(frozen=True)
class Source:
    """A block on its way into a file.

    Parameters
    ----------
    block : CompensatorBlock or SupervisedBlock
        Kind, settings and scan time.
    name : str
        Name of the block in the PLC.
    date : str
        Day of the export, YYYY-MM-DD, as the user gives it: the same input gives the same files.
    real : {"lreal", "real"}
        Arithmetic of the block.
    data, fit, interval : str
        Where the settings come from, one line each, for the header.

    Raises
    ------
    ParameterError
        A name, a date or a setting that cannot be used.
    """

    block: CompensatorBlock | SupervisedBlock
    name: str
    date: str
    real: str = "lreal"
    data: str = UNKNOWN
    fit: str = UNKNOWN
    interval: str = UNKNOWN
    tree: Block = field(init=False, repr=False)

    def __post_init__(self) -> None:
        block_name(self.name, {variable.name.lower() for variable in self.specification.variables})
        if self.real not in TYPES:
            raise ParameterError.expected(f"real out of {list(TYPES)}", self.real, "LREAL where the PLC has it")
        _check_date(self.date)
        for variable, value in zip(self.specification.section("parameter"), self.parameters, strict=True):
            name = variable.name.lower()
            if not np.isfinite(value):
                raise ParameterError.expected(f"a {name} within {self.real.upper()}", value, "take LREAL")
            if variable.kind == "bool" and value not in (0.0, 1.0):
                raise ParameterError.expected(f"{name} 0 or 1", value, "it is a flag")
            if variable.kind == "int" and (value != int(value) or abs(value) >= LARGEST_INT):
                raise ParameterError.expected(f"a whole {name} below 2^31", value, "it is a count")
        tree = translate(self.specification.module.step, self.specification.variables)
        object.__setattr__(self, "tree", tree)

    @property
    def specification(self) -> Specification:
        """Kernel and variables."""
        return self.block.specification

    @property
    def supervised(self) -> bool:
        """Whether a supervisor asks and an operator accepts."""
        return isinstance(self.block, SupervisedBlock)

    @property
    def dtype(self) -> npt.DTypeLike:
        """float64 for LREAL, float32 for REAL."""
        return TYPES[self.real]

    @cached_property
    def parameters(self) -> npt.NDArray[np.floating[Any]]:
        """Parameter array of the kernel, in the arithmetic of the block."""
        with np.errstate(over="ignore"):
            return self.block.parameters(self.dtype)

    @property
    def values(self) -> dict[str, float]:
        """Every parameter by lower-case name, as the block holds it."""
        names = [variable.name.lower() for variable in self.specification.section("parameter")]
        return dict(zip(names, (float(value) for value in self.parameters), strict=True))

    def variables(self, section: str) -> list[Name]:
        """Variables of a section as the tree names them."""
        return [Name(v.section, v.name, v.kind) for v in self.specification.section(section)]

    def constant(self, kind: str, value: float, true: str = "TRUE", false: str = "FALSE") -> str:
        """A default as every dialect reads it."""
        if kind == "bool":
            return true if value else false
        if kind == "int":
            return str(int(value))
        return real_text(value, self.real)

    def header(self, verified: str, said: Callable[[str], str] = anywhere) -> list[str]:
        """Lines at the top of every file; what others wrote goes through `said` of :mod:`lostmotion.export.outside`."""
        values = self.values
        return [
            f"{self.name}: compensates {self.specification.title}. Made by lostmotion {_version()}, {self.date}.",
            f"Source: {self.specification.source}.",
            f"Data: {said(self.data)}",
            f"Fit: {said(self.fit)}",
            f"Interval: {said(self.interval)}",
            *([f"ACCEPTED behind a closed gate: {said(self.block.accepted)}"] if self.block.accepted else []),
            *([SUPERVISED] if self.supervised else []),
            f"Settings: {said('; '.join(self.block.notes)) or UNKNOWN}",
            f"Limits: OP_OUT within {values['low']:.6g} .. {values['high']:.6g}, "
            f"offset within +-{values['cap']:.6g}, "
            f"{values['ramp_step']:.6g} a scan while switching, units of OP.",
            f"Scan time: {self.block.scan_time:g} s. Call it once in each scan of this length: ramp_step and rate "
            "count in scans.",
            f"Arithmetic: {self.real.upper()}. No retained data: the first scan after a start is without a bump.",
            f"Verified: {verified}",
            "Read the commissioning page before the download, and try the block in manual first.",
        ]


def real_text(value: float, real: str) -> str:
    """Shortest decimal that reads back as the same number, with a point, e.g. 1.0E-6."""
    text = str(np.float32(value) if real == "real" else np.float64(value))
    mantissa, _, exponent = text.partition("e")
    if "." not in mantissa:
        mantissa += ".0"
    return f"{mantissa}E{int(exponent)}" if exponent else mantissa


def _check_date(date: str) -> None:
    """Refuse what is no day; of the other forms of ISO 8601 a tool knows nothing."""
    try:
        day = dt.date.fromisoformat(date).isoformat()
    except (TypeError, ValueError):
        day = ""
    if day != date:
        raise ParameterError.expected("a date as YYYY-MM-DD", repr(date)[:40], "give the day of the export")


def _version() -> str:
    try:
        return version("lostmotion")
    except PackageNotFoundError:
        return "(not installed)"
