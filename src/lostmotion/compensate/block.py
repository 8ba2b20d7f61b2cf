"""CompensatorBlock: one compensating block with its settings, run scan by scan or over a record."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.arguments import numbers, positive
from lostmotion.arrays import FloatArray, IntArray, Reals
from lostmotion.brief import Brief, counted
from lostmotion.compensate.specification import SPECIFICATIONS, Specification, present_names
from lostmotion.errors import DataError, ParameterError
from lostmotion.kernels.blocks import core as kernel

MOST_FACTOR = kernel.MOST_FACTOR  # twice the lost motion: more than studies of wrong estimates ask for
LEAST_SETTING, MOST_SETTING = 1e-12, kernel.MOST_SETTING  # 32 bits have room for their products; scans go to 3e8
FACTOR_NOTE = re.compile(r"factor (\d+(?:\.\d+)?):")
NOTED = 1e-3  # of the factor: notes have three digits
REFUSED = {
    1.0: ("low <= high, ramp_step >= 0, all finite", "low, high, ramp_step, safe"),
    2.0: ("factor, band, quiet, rate, cap >= 0, count_limit >= 1, all finite", "factor, band, quiet, rate, cap"),
    3.0: ("usable settings of the kind, all finite", "widths, slopes, scans"),
}


@dataclass(frozen=True, eq=False, repr=False)
class BlockResponse(Brief):
    """Outputs of a block over a record, each of shape (n,); the same names as in the PLC, in lower case.

    Attributes
    ----------
    op_out, offset, back : command, offset in it, OP_IN that belongs to the command
    direction, reversals, state, error : whole numbers
    limited_low, limited_high, offset_capped, ramping : flags
    """

    op_out: Reals
    offset: Reals
    back: Reals
    direction: IntArray
    reversals: IntArray
    state: IntArray
    limited_low: npt.NDArray[np.bool_]
    limited_high: npt.NDArray[np.bool_]
    offset_capped: npt.NDArray[np.bool_]
    ramping: npt.NDArray[np.bool_]
    error: IntArray

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return (f"{len(self)} scans",)

    def __len__(self) -> int:
        return len(self.op_out)


@dataclass(frozen=True, repr=False)
class CompensatorBlock(Brief):
    """Compensating block as it runs in a PLC: the same kernel, the same settings.

    Made from a fit by ``fit.block()``, from a model by :func:`~lostmotion.compensate.block_from_model`, or here from
    bare settings. The settings are frozen; :meth:`step` keeps a memory that :meth:`reset` clears.

    Parameters
    ----------
    kind : {"dead zone", "backlash", "stiction knocker", "stiction two moves"}
        Kind of block.
    scan_time : float
        Seconds between two scans. RAMP_STEP and RATE are per scan.
    values : tuple of float
        Settings in the order of ``specification.section("parameter")``; :meth:`of` takes them by name.
    notes : tuple of str
        How the settings were found.
    accepted : str
        Reason for which a closed gate was passed (:mod:`lostmotion.compensate.gate`); empty where it was open.

    Raises
    ------
    ParameterError
        Unknown kind, a scan time that is not positive, settings that the block itself would refuse.

    Examples
    --------
    >>> block = CompensatorBlock.of("backlash", 0.1, {"lead_up": 0.5, "lead_down": 0.5, "ramp_step": 0.25})
    >>> [block.step(op) for op in (50.0, 51.0, 52.0, 53.0, 52.0)]
    [50.0, 51.5, 52.5, 53.5, 51.5]
    """

    kind: str
    scan_time: float
    values: tuple[float, ...]
    notes: tuple[str, ...] = ()
    accepted: str = ""
    _memory: Reals = field(init=False, repr=False, compare=False)
    _outputs: Reals = field(init=False, repr=False, compare=False)

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return self.kind, f"every {self.scan_time:g} s", counted(len(self.values), "setting")

    def __post_init__(self) -> None:
        if not isinstance(self.kind, str) or self.kind not in SPECIFICATIONS:
            raise ParameterError.expected(f"kind out of {list(SPECIFICATIONS)}", repr(self.kind), "choose one of them")
        object.__setattr__(self, "scan_time", positive("scan_time", self.scan_time))
        named = self.specification.section("parameter")
        if len(self.values) != len(named):
            raise ParameterError.expected(f"{len(named)} values", len(self.values), "use CompensatorBlock.of()")
        for variable, value in zip(named, self.values, strict=True):
            refuse_setting(variable.name.lower(), value)
        object.__setattr__(self, "values", tuple(float(value) for value in self.values))
        object.__setattr__(self, "notes", _true_notes(self.notes, self.settings["factor"]))
        self.reset()
        self._refuse_unusable()

    @classmethod
    def of(
        cls, kind: str, scan_time: float, settings: Mapping[str, float], notes: tuple[str, ...] = (), accepted: str = ""
    ) -> Self:
        """Block from settings by name; what is not named has its default."""
        if kind not in SPECIFICATIONS:
            raise ParameterError.expected(f"kind out of {list(SPECIFICATIONS)}", repr(kind), "choose one of them")
        values = SPECIFICATIONS[kind].parameters({name: float(value) for name, value in settings.items()})
        return cls(kind, scan_time, tuple(values.tolist()), tuple(notes), accepted)

    def _refuse_unusable(self) -> None:
        """Ask the kernel itself, on a scratch state."""
        outputs = self.specification.outputs(1)
        inputs = np.array([[0.0, 1.0, 1.0, 0.0, 0.0]])
        self.specification.run(self.parameters(), self.specification.state(), inputs, outputs)
        fault = float(outputs[0, kernel.ERROR])
        if fault:
            expected, where = REFUSED[fault]
            shown = {name: value for name, value in self.settings.items() if fault == 3.0 or name in where}
            raise ParameterError.expected(expected, shown, f"look at {where}")

    @property
    def specification(self) -> Specification:
        """Kernel and variables of this kind."""
        return SPECIFICATIONS[self.kind]

    @property
    def settings(self) -> dict[str, float]:
        """Settings by name."""
        names = (variable.name.lower() for variable in self.specification.section("parameter"))
        return dict(zip(names, self.values, strict=True))

    def changed(
        self, scan_time: float | None = None, *, ramp: float | None = None, **settings: float
    ) -> CompensatorBlock:
        """The block as it was saved, with other settings where they are given.

        Parameters
        ----------
        scan_time : float, optional
            Must be that of the block: ramp, rate and counts are in scans.
        ramp : float, optional
            In units of OP a second, as wherever a block is made; `ramp_step` is a scan's.
        **settings : float
            Any other setting by name.

        Raises
        ------
        ParameterError
            Another scan time, or settings that the block refuses.
        """
        if scan_time is not None and not abs(scan_time - self.scan_time) <= 1e-9 * self.scan_time:
            remedy = "make the block again for this scan time"
            raise ParameterError.expected(f"the scan time of the block, {self.scan_time:g} s", scan_time, remedy)
        if ramp is not None:
            settings["ramp_step"] = positive("ramp", ramp) * self.scan_time
        return self.with_settings(**settings) if settings else self

    def parameters(self, dtype: npt.DTypeLike = np.float64) -> Reals:
        """Parameter array of the kernel."""
        return np.array(self.values, dtype=dtype)

    def with_settings(self, **changes: float) -> CompensatorBlock:
        """The same block with other settings; those that run go on from a reset."""
        settings = {**self.settings, **present_names(changes)}
        return CompensatorBlock.of(self.kind, self.scan_time, settings, self.notes, self.accepted)

    def step(self, op_in: float, enable: bool = True, good: bool = True, track_value: float | None = None) -> float:
        """Command of one scan.

        Parameters
        ----------
        op_in : float
            Controller output; NaN and infinities are answered by holding the command.
        enable : bool
            Compensate; False passes OP through.
        good : bool
            Quality of OP_IN.
        track_value : float, optional
            In manual: the command to follow.
        """
        tracked = 0.0 if track_value is None else track_value
        inputs = np.array([op_in, enable, good, track_value is not None, tracked], dtype=np.float64)
        with np.errstate(all="ignore"):
            self.specification.module.step(self.parameters(), self._memory, inputs, self._outputs)
        return float(self._outputs[kernel.OP_OUT])

    @property
    def last(self) -> dict[str, float]:
        """All outputs of the last :meth:`step`."""
        names = (variable.name.lower() for variable in self.specification.section("output"))
        return dict(zip(names, self._outputs.tolist(), strict=True))

    def reset(self) -> None:
        """Forget the past: the next scan is a first scan."""
        object.__setattr__(self, "_memory", self.specification.state())
        object.__setattr__(self, "_outputs", self.specification.outputs(1)[0])

    def run(
        self,
        op_in: npt.ArrayLike,
        enable: npt.ArrayLike = True,
        good: npt.ArrayLike = True,
        track: npt.ArrayLike = False,
        track_value: npt.ArrayLike = 0.0,
        dtype: npt.DTypeLike = np.float64,
    ) -> BlockResponse:
        """Outputs over a record, from a first scan; the memory of :meth:`step` is not touched.

        Parameters
        ----------
        op_in : array_like, shape (n,)
            Controller output.
        enable, good, track, track_value : bool, float or array_like, shape (n,)
            The other inputs.
        dtype : {float64, float32}
            LREAL or REAL arithmetic.

        Raises
        ------
        DataError
            Inputs of different length.
        """
        parts = [numbers("input", part) for part in (op_in, enable, good, track, track_value)]
        n = parts[0].size
        if parts[0].ndim != 1 or any(part.ndim > 1 or part.size not in (1, n) for part in parts):
            raise DataError.expected(f"inputs with {n} samples", [part.shape for part in parts], "give one dimension")
        with np.errstate(all="ignore"):
            inputs = np.column_stack([np.broadcast_to(part, n) for part in parts]).astype(dtype)
            outputs = self.specification.outputs(n, dtype)
            self.specification.run(self.parameters(dtype), self.specification.state(dtype), inputs, outputs)
        return _response(self.specification, outputs)

    def __call__(self, uc: npt.ArrayLike) -> float | FloatArray:
        """Commands for controller outputs, a scalar or shape (n,), enabled from a first scan on."""
        array = np.atleast_1d(numbers("uc", uc))
        command = self.run(array).op_out.astype(np.float64)
        return float(command[0]) if np.ndim(uc) == 0 else command

    def _repr_html_(self) -> str:
        """Headline and a small table, for notebooks."""
        return _verbs.panel(self).html()

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        data = {"kind": self.kind, "scan_time": self.scan_time, "settings": self.settings, "notes": list(self.notes)}
        return data | ({"accepted": self.accepted} if self.accepted else {})

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        names = ("kind", "scan_time", "settings")
        if any(name not in data for name in names):
            raise ParameterError.expected(f"keys {list(names)}", sorted(data), "use to_dict()")
        return cls.of(
            data["kind"], data["scan_time"], data["settings"], tuple(data.get("notes", ())), data.get("accepted", "")
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.kind, self.scan_time, self.values, self.notes, self.accepted)


def refuse_setting(name: str, value: float) -> None:
    """Raise the ParameterError of a setting that no block has; what belongs together the kernel checks itself."""
    most = MOST_FACTOR if name == "factor" else MOST_SETTING
    if not math.isfinite(value):
        raise ParameterError.expected(f"finite {name}", value, "give a number")
    if abs(value) > most or 0.0 < abs(value) < LEAST_SETTING:
        remedy = "give a share of the lost motion" if name == "factor" else "give it in units of OP, or in scans"
        raise ParameterError.expected(f"{name} as 0, or from {LEAST_SETTING:g} to {most:g}", value, remedy)


def _true_notes(notes: tuple[str, ...], factor: float) -> tuple[str, ...]:
    """Notes in which the share is the one in force: it can be changed, in a file as well."""
    stated = [FACTOR_NOTE.match(note) for note in notes]
    if all(found is None or abs(float(found[1]) - factor) <= NOTED for found in stated):
        return notes
    return (*(note for note, found in zip(notes, stated, strict=True) if found is None), f"factor {factor:.3f}: given")


def _response(specification: Specification, outputs: Reals) -> BlockResponse:
    """Columns of the outputs as arrays of their kinds."""
    types: dict[str, Any] = {"real": outputs.dtype, "int": np.int64, "bool": np.bool_}
    columns = {
        variable.name.lower(): outputs[:, k].astype(types[variable.kind])
        for k, variable in enumerate(specification.section("output"))
    }
    return BlockResponse(**{item.name: columns[item.name] for item in fields(BlockResponse)})
