"""A PLC in this process: the kernel of a supervised block behind a link, scan by scan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np
import numpy.typing as npt

from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.live.link import LinkError

DINT = 2**31
WRITABLE = ("request_id", "asked_factor", "asked_first", "asked_second", "checksum", "heartbeat")


class VirtualPlc:
    """A supervised block that scans, and a :class:`~lostmotion.live.link.Link` to it.

    Parameters
    ----------
    block : SupervisedBlock
    dtype : {float64, float32}
        LREAL or REAL arithmetic.
    """

    def __init__(self, block: SupervisedBlock, dtype: npt.DTypeLike = np.float64) -> None:
        self.block = block
        self.specification = block.specification
        self._names = {
            section: [variable.name.lower() for variable in self.specification.section(section)]
            for section in ("parameter", "input", "output")
        }
        self.settings = block.parameters(dtype)
        self.inputs = np.array([[v.default for v in self.specification.section("input")]], dtype=dtype)
        self.restart()

    def restart(self) -> None:
        """As after a download or a loss of power: the memory is cold, what others wrote stands where it stood."""
        self._state = self.specification.state(self.settings.dtype)
        self.outputs = self.specification.outputs(1, self.settings.dtype)

    def set(self, name: str, value: float) -> None:
        """A setting, or an input that is wired in the PLC: OP_IN, quality, modes, the operator's accept."""
        if name in self._names["parameter"]:
            self.settings[self._names["parameter"].index(name)] = value
        else:
            self.inputs[0, self._names["input"].index(name)] = value

    def scan(self, op_in: float) -> float:
        """One scan; returns the command to the valve."""
        self.set("op_in", op_in)
        self._execute()
        return float(self.outputs[0, 0])

    def close(self) -> None:
        """Nothing is open."""

    def _execute(self) -> None:
        """Inputs and settings to outputs."""
        self.specification.run(self.settings, self._state, self.inputs, self.outputs)

    def read(self, names: Iterable[str]) -> Mapping[str, float]:
        """Values of inputs and outputs."""
        known = dict(zip(self._names["input"], self.inputs[0].tolist(), strict=True))
        known |= zip(self._names["output"], self.outputs[0].tolist(), strict=True)
        wanted = list(names)
        missing = sorted(set(wanted) - set(known))
        if missing:
            raise LinkError(f"expected names of the block, got {missing}; see its inputs and outputs")
        return {name: known[name] for name in wanted}

    def write(self, values: Mapping[str, int]) -> None:
        """Write inputs of the supervision; all others belong to the PLC, and DINT holds no NaN."""
        for name, value in values.items():
            if name not in WRITABLE:
                raise LinkError(f"expected a name out of {WRITABLE}, got {name}; the PLC owns the others")
            if not (abs(value) < DINT and int(value) == value):
                raise LinkError(f"expected a whole number for {name}, got {value}; it is a DINT")
            self.set(name, float(value))
