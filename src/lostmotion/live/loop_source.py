"""A loop of a server as a source of `online`: values go in as they come, rows of a fixed rate come out."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from threading import Event
from typing import Any

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.files.cells import Cells
from lostmotion.files.grid import Grid, Note, Rows
from lostmotion.files.layout import Layout
from lostmotion.files.schema import checked, group, number, one_of, or_null, row, table, text, whole
from lostmotion.files.times import time_text
from lostmotion.live.joined import KINDS, Joined, Row
from lostmotion.live.value import Value
from lostmotion.online.stored import GRID, LONG, REMEDY, WHAT, positive, seconds

VERSION = 1
KIND = "server"
_HELD = row(or_null(number(-LONG, LONG)), or_null(number()))
POSITION = group(
    version=one_of(VERSION), kind=one_of(KIND), dt=positive, nodes=table(text(10_000), 10), rows=whole(),
    joined=group(
        last=or_null(seconds), held=table(_HELD, 10), counts=group(**dict.fromkeys(KINDS, whole()))
    ),
    grid=GRID,
)  # fmt: skip
_EMPTY = Rows(np.zeros(0), np.zeros(0), np.zeros(0))


def check_position(position: Any) -> float:
    """Sampling time of a position; DataError where it is none."""
    return float(checked(position, POSITION, WHAT, REMEDY)["dt"])


@dataclass(frozen=True)
class Signals:
    """What is read of a loop.

    Attributes
    ----------
    name : str
        Of the loop.
    nodes : dict of str
        Addresses in the server by role; "op" and "pv" at least.
    dt : float
        Sampling time in seconds.
    patience : float
        See :class:`lostmotion.live.joined.Joined`.
    on_change : bool
        See there.
    """

    name: str
    nodes: dict[str, str]
    dt: float
    patience: float
    on_change: bool = False


class LoopSource:
    """Rows of one loop; see :class:`lostmotion.online.source.RowSource`.

    Parameters
    ----------
    signals : Signals
    position : dict, optional
        From :attr:`position`: go on behind it.
    clock : callable
        Seconds on a clock that never steps.

    Raises
    ------
    ParameterError
        `position` is of other nodes or of another sampling time.
    """

    def __init__(
        self,
        signals: Signals,
        position: dict[str, Any] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.signals, self._clock = signals, clock
        if position is not None and (position["nodes"] != signals.nodes or position["dt"] != signals.dt):
            got = f"{signals.nodes}, {signals.dt:g} s"
            raise ParameterError.expected(f"{position['nodes']}, {position['dt']:g} s as before", got, "start anew")
        stored = position or {}
        roles = tuple(role for role in ("op", "mode") if role in signals.nodes)
        self._joined = Joined(signals.dt, signals.patience, roles, signals.on_change, stored.get("joined"))
        self._grid = Grid(signals.dt, calendar="UTC", state=stored.get("grid"), word="Row")
        self._rows = stored.get("rows", 0)
        self._inbox: deque[list[Value]] = deque()
        self._why = ""  # of the last PV
        self.alive: float | None = None

    @property
    def name(self) -> str:
        """Of the loop."""
        return self.signals.name

    @property
    def layout(self) -> Layout:
        """What the rows are."""
        nodes = self.signals.nodes
        names = tuple(nodes[role] for role in ("op", "pv", "mode") if role in nodes)
        head = Layout(
            "", names, ",", nodes["op"], nodes["pv"], "SourceTimestamp", nodes.get("mode"), ".", self.signals.dt
        )
        return replace(head, calendar="UTC")

    @property
    def ended(self) -> bool:
        """A server never ends."""
        return False

    @property
    def more(self) -> bool:
        """Values wait that came since."""
        return bool(self._inbox)

    @property
    def waiting(self) -> int:
        """Values of PV that are in no row yet, about."""
        return self._joined.waiting + sum(value.role == "pv" for values in tuple(self._inbox) for value in values)

    @property
    def newest(self) -> float:
        """Stamp of the newest PV that is known; minus infinity before the first."""
        return self._joined.newest

    @property
    def counts(self) -> dict[str, int]:
        """Values and rows, and those of each kind of trouble."""
        return {**self._joined.counts, **self._grid.counts}

    @property
    def position(self) -> dict[str, Any]:
        """Place of the last row given, JSON-ready."""
        return {
            "version": VERSION,
            "kind": KIND,
            "dt": self.signals.dt,
            "nodes": dict(self.signals.nodes),
            "rows": self._rows,
            "joined": self._joined.state,
            "grid": self._grid.state,
        }

    def feed(self, values: list[Value]) -> None:
        """Take values; from any thread."""
        if values:
            self._inbox.append(values)

    def broken(self) -> None:
        """The link is broken: nothing holds over that."""
        self.alive = None
        self._inbox.append([])

    def read(self, most: int) -> Rows:
        """Rows that are complete, up to about `most`."""
        while self._inbox:
            values = self._inbox.popleft()
            self._joined.feed(values) if values else self._joined.broken()
        rows = self._joined.take(most, self._clock(), self.alive) if most else []
        return self._placed(rows) if rows else _EMPTY

    def finish(self, most: int) -> Rows:
        """As :meth:`read`: there is no end."""
        return self.read(most)

    def wait(self, seconds: float, stop: Event) -> None:
        """Sleep."""
        stop.wait(seconds)

    def _placed(self, rows: list[Row]) -> Rows:
        if rows[0].restart:
            self._grid.restart()
        n = len(rows)
        automatic = np.array([row.held["mode"] == 1.0 for row in rows]) if "mode" in rows[0].held else None
        cells = Cells(
            np.array([row.stamp for row in rows]),
            np.array([row.held["op"] for row in rows]),
            np.array([row.pv for row in rows]),
            automatic,
            np.zeros(n, dtype=bool),
            np.arange(n),
        )
        placed = self._grid.place(cells, self._rows + 1 + np.arange(n))
        self._rows += n
        return replace(placed, notes=(*placed.notes, *self._quality(rows)))

    def _quality(self, rows: Iterable[Row]) -> list[Note]:
        """Say when the quality of PV turns."""
        found = []
        for number_, one in enumerate(rows, self._rows):
            if one.why != self._why:
                said = f"PV is {one.why}: missing until it is good" if one.why else "PV is good again"
                found.append(Note(number_, one.stamp, f"{time_text(one.stamp, 'UTC')}: {said}."))
                self._why = one.why
        return found


def patience_of(dt: float, publishing: float) -> float:
    """Seconds that a row waits for an OP of the same scan: a quarter of a sample, and the way here."""
    return 0.25 * dt + publishing + 0.1
