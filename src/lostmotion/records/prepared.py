"""Prepared: the stretches of a record that identification may use, and why the rest was left out."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lostmotion.brief import Brief, counted
from lostmotion.errors import DataError
from lostmotion.records.compression import MadeUp
from lostmotion.records.record import LoopRecord

_SHOWN = 3  # stretches of one kind that are named


@dataclass(frozen=True)
class LeftOut:
    """Rows start .. stop - 1 (from 0) that are not used, and why.

    Attributes
    ----------
    start, stop : int
        Rows of the record as it was handed in, stop exclusive.
    kind : str
        Short name: "missing", "stopped", "stuck PV", "held OP", "mode", "clipped PV", "outlier", "splice", "short".
    """

    start: int
    stop: int
    kind: str

    def __len__(self) -> int:
        return self.stop - self.start


WHY = {
    "missing": "OP or PV is missing",
    "stopped": "OP and PV both stand still, so the recording had stopped",
    "stuck PV": "PV stands still although its noise is visible elsewhere, so the sensor stuck",
    "held OP": "OP stands still for long while PV moves: manual, or an OP that was not recorded",
    "mode": "in this mode the actuator need not follow OP",
    "clipped PV": "PV is at the end of its range",
    "outlier": "PV jumps away from its neighbours and back",
    "splice": "another recording was glued on there, perhaps of another loop",
    "short": "the piece between the rows left out is too short",
}


@dataclass(frozen=True, eq=False, repr=False)
class Prepared(Brief):
    """What of a record may be used.

    Attributes
    ----------
    record : LoopRecord
        As it was handed in.
    stretches : tuple of LoopRecord
        Pieces to identify from, each without gap or missing sample; empty where the record is refused.
    rows : tuple of (start, stop)
        Rows of `record` that each stretch comes from, stop exclusive.
    left_out : tuple of LeftOut
        Every row that is in no stretch, once, in ascending order.
    notes : tuple of str
        Sentences: what was left out or changed and why, what to know when reading the result.
    refusal : str or None
        Why nothing may be used; None where `stretches` is not empty.
    op_step, pv_step : float
        Step in which the signal was stored; 0: none is visible.
    made_up : MadeUp or None
        Shares of the rows that a historian made up, see `lostmotion.records.compression`.
    origin : str
        Fingerprint of what was handed in, where `record` is the slower scan that it repeats; else "".
    """

    record: LoopRecord
    stretches: tuple[LoopRecord, ...]
    rows: tuple[tuple[int, int], ...]
    left_out: tuple[LeftOut, ...]
    notes: tuple[str, ...]
    refusal: str | None = None
    op_step: float = 0.0
    pv_step: float = 0.0
    made_up: MadeUp | None = None
    origin: str = ""

    @property
    def fingerprint(self) -> str:
        """That of the record as it was handed in."""
        return self.origin or self.record.fingerprint

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        used = f"{100.0 * self.share:.3g} % of {len(self.record)} rows in {counted(len(self.rows), 'piece')}"
        return (used if self.usable else "refused",)

    @property
    def usable(self) -> bool:
        """Whether anything is left to identify from."""
        return self.refusal is None

    @property
    def share(self) -> float:
        """Share of the rows that is used."""
        return sum(stop - start for start, stop in self.rows) / len(self.record)

    def require(self) -> tuple[LoopRecord, ...]:
        """Stretches, or a DataError with the reason where there are none.

        Raises
        ------
        DataError
            The record is refused.
        """
        if self.refusal is not None:
            name = f"{self.record.tag}: " if self.record.tag else ""
            raise DataError(f"{name}{self.refusal}")
        return self.stretches

    def summary(self) -> str:
        """Lines of text: how much is used, then the notes."""
        used = sum(stop - start for start, stop in self.rows)
        pieces = f"{len(self.rows)} piece{'s' if len(self.rows) != 1 else ''}"
        head = f"Identification would use {used} of {len(self.record)} rows in {pieces}."
        return "\n".join([head if self.usable else f"Refused: {self.refusal}", *(f"  {note}" for note in self.notes)])

    def to_dict(self) -> dict[str, Any]:
        """Everything but the signals, ready for JSON."""
        return {
            "usable": self.usable,
            "refusal": self.refusal,
            "rows": [list(pair) for pair in self.rows],
            "left_out": [{"start": part.start, "stop": part.stop, "kind": part.kind} for part in self.left_out],
            "notes": list(self.notes),
            "op_step": self.op_step,
            "pv_step": self.pv_step,
        }

    def __str__(self) -> str:
        return self.summary()


def where(start: int, stop: int, dt: float) -> str:
    """Rows (from 1) and times of a stretch.

    Examples
    --------
    >>> where(9, 20, 0.5), where(9, 10, 0.5)
    ('rows 10 to 20 (t = 4.5 to 9.5 s)', 'row 10 (t = 4.5 s)')
    """
    if stop - start == 1:
        return f"row {start + 1} (t = {start * dt:g} s)"
    return f"rows {start + 1} to {stop} (t = {start * dt:g} to {(stop - 1) * dt:g} s)"


def sentences(left_out: tuple[LeftOut, ...], record: LoopRecord) -> list[str]:
    """One sentence for each kind of rows left out.

    Examples
    --------
    >>> record = LoopRecord([0.0] * 50, [0.0] * 50, dt=1.0)
    >>> print(*sentences((LeftOut(3, 4, "outlier"), LeftOut(9, 11, "outlier")), record))
    Left out, 3 rows (6 %), PV jumps away from its neighbours and back: row 4 (t = 3 s), rows 10 to 11 (t = 9 to 10 s).
    """
    said = []
    for kind, why in WHY.items():
        parts = [part for part in left_out if part.kind == kind]
        if not parts:
            continue
        count = sum(len(part) for part in parts)
        longest = sorted(sorted(parts, key=len, reverse=True)[:_SHOWN], key=lambda part: part.start)
        named = ", ".join(where(part.start, part.stop, record.dt) for part in longest)
        more = f" and {len(parts) - _SHOWN} shorter or equal" if len(parts) > _SHOWN else ""
        share = f"{100 * count / len(record):.2g} %"
        said.append(f"Left out, {count} row{'s' if count > 1 else ''} ({share}), {why}: {named}{more}.")
    return said
