"""What a compensating block is made of, as data: its scan kernel and every variable of it.

Simulation, exported code, parameter lists and documentation read this; the order of the variables of a section is the
order of their constants in the kernel.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import ModuleType

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import Reals
from lostmotion.compensate import variables as listed
from lostmotion.compensate.variables import Variable
from lostmotion.errors import ParameterError
from lostmotion.kernels.blocks import backlash, core, dead_zone, knocker, run, two_moves


@dataclass(frozen=True)
class Specification:
    """One kind of block.

    Attributes
    ----------
    title : str
        Kind, as in ``SPECIFICATIONS``.
    number : int
        Kind in :mod:`lostmotion.kernels.blocks.run`.
    module : module
        Kernel: ``step(p, s, i, o)`` and the index constants.
    variables : tuple of Variable
        All of them, section by section, in the order of their indices.
    source : str
        Where the method is from, in one line.
    """

    title: str
    number: int
    module: ModuleType
    variables: tuple[Variable, ...]
    source: str

    @property
    def fault(self) -> str:
        """Kind of actuator that it is for."""
        return "stiction" if self.title.startswith("stiction") else self.title

    def section(self, name: str) -> tuple[Variable, ...]:
        """Variables of "parameter", "input", "state" or "output"."""
        return tuple(variable for variable in self.variables if variable.section == name)

    def index(self, name: str) -> int:
        """Index of a variable in its array."""
        return int(getattr(self._owner(name), name))

    def parameters(self, values: Mapping[str, float], dtype: npt.DTypeLike = np.float64) -> Reals:
        """Parameter array: defaults, replaced by `values` (keys in lower case; former names are understood).

        Raises
        ------
        ParameterError
            A name that is no parameter of this block, or a parameter under two names.
        """
        values = present_names(values)
        known = {variable.name.lower(): variable.default for variable in self.section("parameter")}
        unknown = sorted(set(values) - set(known))
        if unknown:
            raise ParameterError.expected(f"parameters out of {sorted(known)}", unknown, "see the parameter list")
        return np.array([values.get(name, default) for name, default in known.items()], dtype=dtype)

    def state(self, dtype: npt.DTypeLike = np.float64) -> Reals:
        """State before the first scan: all zero, as a PLC finds it after a download."""
        return np.zeros(len(self.section("state")), dtype=dtype)

    def outputs(self, rows: int, dtype: npt.DTypeLike = np.float64) -> Reals:
        """Room for the outputs of `rows` scans."""
        return np.zeros((rows, len(self.section("output"))), dtype=dtype)

    def run(self, p: Reals, s: Reals, inputs: Reals, outputs: Reals) -> None:
        """All scans of `inputs` (n, n_inputs) into `outputs` (n, n_outputs), with settings `p`; `s` goes on."""
        with np.errstate(all="ignore"):  # NaN and infinities are answered, not warned of
            run.run(self.number, p, s, inputs, outputs)

    def _owner(self, name: str) -> ModuleType:
        """Module that defines a constant: the kind's, or that of the safeguards."""
        return self.module if hasattr(self.module, name) else core


def present_names(values: Mapping[str, float]) -> dict[str, float]:
    """Settings by the names of today, from those of saved blocks of any age.

    Raises
    ------
    ParameterError
        A setting under its present and its former name.
    """
    for former, name in listed.FORMER.items():
        if former in values and name in values:
            raise ParameterError.expected(f"{name} once", f"{former} as well", f"leave out {former}, its former name")
    return {listed.FORMER.get(name, name): value for name, value in values.items()}


def _specification(
    title: str, number: int, module: ModuleType, own: tuple[Variable, ...], source: str
) -> Specification:
    """Common variables first in each section, then those of the kind."""
    every = (*listed.COMMON, *own)
    order = [variable for section in listed.SECTIONS for variable in every if variable.section == section]
    return Specification(title, number, module, tuple(order), source)


DEAD_ZONE = _specification(
    "dead zone",
    run.DEAD_ZONE,
    dead_zone,
    listed.DEAD_ZONE,
    "Cequeira, Vale, Fonseca, Araujo, Maitelli, ICINCO 2010, eqs 8-11; hysteresis, smoothing and safeguards are ours",
)
BACKLASH = _specification(
    "backlash",
    run.BACKLASH,
    backlash,
    listed.BACKLASH,
    "inverse of the play operator, as in Tao and Kokotovic, IEEE Trans. Automatic Control 38 (1993) (as recalled); "
    "noise band, knock and safeguards are ours",
)
KNOCKER = _specification(
    "stiction knocker",
    run.KNOCKER,
    knocker,
    listed.KNOCKER,
    "Hagglund, Journal of Process Control 12 (2002) (as recalled); band and safeguards are ours",
)
TWO_MOVES = _specification(
    "stiction two moves",
    run.TWO_MOVES,
    two_moves,
    listed.TWO_MOVES,
    "Srinivasan and Rengaswamy, Computers and Chemical Engineering 32 (2008) (as recalled); aim, release and "
    "safeguards are ours",
)
SPECIFICATIONS: dict[str, Specification] = {kind.title: kind for kind in (DEAD_ZONE, BACKLASH, KNOCKER, TWO_MOVES)}
