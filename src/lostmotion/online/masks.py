"""Samples that must not be learned from: manual mode, OP at its limits, a frozen transmitter."""

from __future__ import annotations

from typing import Any

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.files.grid import Rows
from lostmotion.records.limits import SPAN_MARGIN
from lostmotion.records.sampling import Bools

REASONS = ("manual", "saturated", "frozen")


class Masks:
    """Decide sample by sample; the result does not depend on how the rows are cut.

    Parameters
    ----------
    op_limits : (float, float), optional
        Where OP saturates; within 0.5 % of that span of a limit it counts as there.
    frozen : int, optional
        So many equal values of PV in a row mean a frozen transmitter; None: never. A dead zone holds PV still as
        well, so this must be longer than the process rests in routine operation.

    Raises
    ------
    ParameterError
        Limits out of order, or `frozen` below 2.
    """

    def __init__(self, op_limits: tuple[float, float] | None = None, frozen: int | None = None) -> None:
        if op_limits is not None and not (np.isfinite(op_limits).all() and op_limits[0] < op_limits[1]):
            raise ParameterError.expected("OP limits (low, high), low < high", op_limits, "e.g. 0 and 100")
        if frozen is not None and frozen < 2:
            raise ParameterError.expected("frozen >= 2 samples, or None", frozen, "e.g. 100")
        self.op_limits, self.frozen = op_limits, frozen
        self.counts = dict.fromkeys(REASONS, 0)
        self._value, self._run = float("nan"), 0  # last PV, and how often in a row

    @property
    def state(self) -> dict[str, Any]:
        """What the next rows need, JSON-ready."""
        value = None if np.isnan(self._value) else self._value
        return {"counts": dict(self.counts), "value": value, "run": self._run}

    @state.setter
    def state(self, stored: dict[str, Any]) -> None:
        self.counts = dict(stored["counts"])
        self._value = float("nan") if stored["value"] is None else float(stored["value"])
        self._run = int(stored["run"])

    def use(self, rows: Rows) -> Bools:
        """Give True for each sample that may be learned from."""
        found = {"manual": ~rows.automatic if rows.automatic is not None else np.zeros(len(rows), dtype=bool)}
        found["saturated"] = self._saturated(rows)
        found["frozen"] = self._frozen(rows)
        use = np.ones(len(rows), dtype=bool)
        for reason in REASONS:
            self.counts[reason] += int((found[reason] & use).sum())
            use &= ~found[reason]
        return use

    def _saturated(self, rows: Rows) -> Bools:
        if self.op_limits is None:
            return np.zeros(len(rows), dtype=bool)
        low, high = self.op_limits
        margin = SPAN_MARGIN * (high - low)
        return np.asarray((rows.op <= low + margin) | (rows.op >= high - margin))

    def _frozen(self, rows: Rows) -> Bools:
        """From the `frozen`-th equal value on; a missing sample does not end a run."""
        found = np.zeros(len(rows), dtype=bool)
        known = np.flatnonzero(~np.isnan(rows.pv))
        if self.frozen is None or not known.size:
            return found
        values = np.concatenate([[self._value], rows.pv[known]])
        places = np.arange(values.size)
        places[0] = 1 - self._run  # where the run began that goes on
        begins = np.concatenate([[True], values[1:] != values[:-1]])
        runs = np.arange(values.size) - np.maximum.accumulate(np.where(begins, places, places[0])) + 1
        self._value, self._run = float(values[-1]), int(runs[-1])
        found[known] = runs[1:] >= self.frozen
        return found
