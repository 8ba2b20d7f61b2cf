"""Sample loops that come with the package: one of each fault, a healthy one, a bad tuning; simulated, with the truth.

>>> import lostmotion as lm
>>> lm.datasets.names()
('FIC-101', 'FIC-102', 'FIC-103', 'LIC-301', 'PIC-401', 'TIC-201')
>>> record = lm.datasets.load("FIC-101")
>>> record
LoopRecord('FIC-101': 2000 samples of OP, PV, SP every 1 s, 2000 s from 2026-03-02 06:00:00)
>>> lm.datasets.truth("FIC-101")["actuator"]
{'kind': 'stiction', 'band': 3.0, 'jump': 2.0, 'model': 'kano'}
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from lostmotion.errors import ParameterError
from lostmotion.files.read import read_loop
from lostmotion.records.record import LoopRecord

__all__ = ["load", "names", "path", "truth"]

_FOLDER = Path(__file__).parent
_ENDING = ".csv.gz"


def names() -> tuple[str, ...]:
    """Tags of the loops."""
    return tuple(sorted(one.name.removesuffix(_ENDING) for one in _FOLDER.glob(f"*{_ENDING}")))


def load(name: str) -> LoopRecord:
    """Return the record of a loop, read as any export is.

    Raises
    ------
    ParameterError
        No loop of this name.
    """
    return read_loop(path(name))


def path(name: str) -> Path:
    """File of a loop, for the commands: a table as a control system exports it, packed.

    Raises
    ------
    ParameterError
        No loop of this name.

    Examples
    --------
    >>> path("FIC-101").name
    'FIC-101.csv.gz'
    """
    if name not in names():
        raise ParameterError.expected(f"one of {', '.join(names())}", repr(name), "choose one of them")
    return _FOLDER / f"{name}{_ENDING}"


def truth(name: str) -> dict[str, Any]:
    """What is true of a loop.

    Returns
    -------
    dict
        `about` in words; `verdict` that is right; `size` of the lost motion in units of OP, None where there is none;
        `actuator` with its parameters, positions counted from `op_at_rest`.

    Raises
    ------
    ParameterError
        No loop of this name.

    Examples
    --------
    >>> truth("TIC-201")["about"]
    'temperature, split range whose heating and cooling valves do not meet'
    """
    path(name)
    known: dict[str, dict[str, Any]] = json.loads((_FOLDER / "truth.json").read_text(encoding="utf-8"))
    return known[name]
