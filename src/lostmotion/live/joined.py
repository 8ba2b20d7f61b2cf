"""Values of OP and PV, each with stamps of its own -> rows: one for each value of PV, with the OP that held then."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from lostmotion.live.value import HELD, Value

SCATTER = 0.25  # samples: tags of one scan are stamped one after the other
STEPPED = 5  # values behind one another on an earlier clock that are believed to be a step of the clock
ASIDE = 100  # values of other signals that are kept until it is clear whether the clock was set
KINDS = ("values", "bad", "duplicates", "late", "behind", "steps")


class Row(NamedTuple):
    """PV, what held then, and whether the clock began anew before it."""

    stamp: float
    pv: float
    held: dict[str, float]
    restart: bool
    at: float
    why: str


@dataclass
class Held:
    """Signal whose last value holds.

    Attributes
    ----------
    stamp, value : float
        Of the last value that a row has used.
    coming : deque of Value
        Later ones.
    """

    stamp: float = -math.inf
    value: float = math.nan
    coming: deque[Value] = field(default_factory=deque)

    @property
    def newest(self) -> float:
        """Stamp of the newest value known."""
        return self.coming[-1].stamp if self.coming else self.stamp

    def until(self, limit: float) -> float:
        """Value that holds at a time; those before it are let go."""
        while self.coming and self.coming[0].stamp <= limit:
            newer = self.coming.popleft()
            self.stamp, self.value = newer.stamp, newer.value
        return self.value


class Joined:
    """Rows of one loop from values in any order of the signals.

    Parameters
    ----------
    dt : float
        Sampling time in seconds.
    patience : float
        Seconds after which a row no longer waits for an OP of the same scan.
    roles : tuple of str
        Signals that hold: "op", and "mode" where there is one.
    on_change : bool
        The server tells PV only where it has changed: while the link is alive its last value holds. Otherwise a
        missing value is a missing sample.
    state : dict, optional
        From :attr:`state`: values up to there are known.

    Notes
    -----
    A row has the stamp of its PV, and the last OP stamped at most a quarter of a sample later. The same stamp twice,
    and one that goes back, are left out and counted; five values that go on from an earlier stamp as time passes are a
    clock that was set, and begin a new recording. Rows do not depend on how values come in pieces, except that one
    whose OP comes later than `patience` is made without it.

    Examples
    --------
    >>> joined = Joined(1.0, patience=0.5)
    >>> joined.feed([Value("op", 0.1, 5.0, 0.2), Value("pv", 0.0, 1.0, 0.2), Value("op", 1.1, 6.0, 1.2)])
    >>> [(row.stamp, row.pv, row.held["op"]) for row in joined.take(10, now=0.3)]
    [(0.0, 1.0, 5.0)]
    """

    def __init__(
        self,
        dt: float,
        patience: float,
        roles: tuple[str, ...] = HELD[:1],
        on_change: bool = False,
        state: dict[str, Any] | None = None,
    ) -> None:
        self.dt, self.patience, self.on_change = dt, patience, on_change
        self._held = {role: Held() for role in roles}
        self._coming: deque[tuple[Value, bool]] = deque()  # PV, and whether the clock was set before it
        self._newest = -math.inf  # stamp of the newest PV
        self._back: list[Value] = []  # values that may be of a clock that was set
        self._aside: deque[Value] = deque(maxlen=ASIDE)  # other signals, of that clock
        self._row: Row | None = None  # the last one
        self._broken = True  # values may have been lost since the last row
        self.counts = dict.fromkeys(KINDS, 0)
        if state:
            self._go_on(state)

    @property
    def state(self) -> dict[str, Any]:
        """What the next rows need of those taken, JSON-ready."""
        held = {role: [_shown(one.stamp), _shown(one.value)] for role, one in self._held.items()}
        return {"last": None if self._row is None else self._row.stamp, "held": held, "counts": dict(self.counts)}

    def _go_on(self, state: dict[str, Any]) -> None:
        self.counts = dict(state["counts"])
        if state["last"] is not None:
            self._newest = state["last"]
        for role, (stamp, value) in state["held"].items():
            if role in self._held:
                known = -math.inf if stamp is None else stamp
                self._held[role] = Held(known, math.nan if value is None else value)

    @property
    def newest(self) -> float:
        """Stamp of the newest PV; minus infinity before the first."""
        return self._newest

    def feed(self, values: Iterable[Value]) -> None:
        """Take values as they come."""
        for value in values:
            self.counts["values"] += 1
            self.counts["bad"] += value.why != ""
            if value.role == "pv":
                self._measured(value)
            elif value.role in self._held:
                self._hold(self._held[value.role], value)

    def broken(self) -> None:
        """Values may be lost from here on: nothing holds over it."""
        self._broken = True

    def _measured(self, value: Value) -> None:
        if math.isinf(self._newest) and math.isnan(value.value):
            return  # a record begins with a measurement
        if value.stamp > self._newest:
            self._back = []
            self._aside.clear()
            self._accept(value, restart=False)
            return
        self.counts["duplicates" if value.stamp == self._newest else "late"] += 1
        if value.stamp < self._newest and self._goes_on(value):
            self._begin_anew()

    def _begin_anew(self) -> None:
        """The clock was set: take what was put aside."""
        again, self._back = self._back, []
        others = list(self._aside)
        self._aside.clear()
        self.counts["steps"] += 1
        self.counts["late"] -= len(again) + len(others)
        for one in self._held.values():
            one.until(math.inf)
            one.stamp = -math.inf
        for value in others:
            self._hold(self._held[value.role], value)
        for number, value in enumerate(again):
            self._accept(value, restart=number == 0)

    def _accept(self, value: Value, restart: bool) -> None:
        self._coming.append((value, restart))
        self._newest = value.stamp

    def _goes_on(self, value: Value) -> bool:
        """Whether values from an earlier stamp on have come one after the other, as fast as their stamps say."""
        if self._back and value.stamp <= self._back[-1].stamp:
            self._back = []
        self._back.append(value)
        first = self._back[0]
        passed, told = value.at - first.at, value.stamp - first.stamp
        return len(self._back) >= STEPPED and passed > 0.5 * told

    def _hold(self, held: Held, value: Value) -> None:
        if value.stamp <= held.newest:
            self.counts["duplicates" if value.stamp == held.newest else "late"] += 1
            if value.stamp < held.newest:
                self._aside.append(value)
            return
        if self._row is not None and value.stamp <= self._row.stamp + SCATTER * self.dt and not self._coming:
            self.counts["behind"] += 1
        held.coming.append(value)

    def take(self, most: int, now: float, alive: float | None = None) -> list[Row]:
        """Rows that are complete, up to about `most`; one that begins a new recording is the first of them.

        Parameters
        ----------
        most : int
        now : float
            On the clock of the values' `at`.
        alive : float, optional
            When the link last proved to be alive, for values that hold.
        """
        rows: list[Row] = []
        while self._coming and len(rows) < most:
            value, restart = self._coming[0]
            if not self._complete(value, now) or (restart and rows):
                break
            self._coming.popleft()
            if not restart:
                self._fill(rows, value.stamp - 0.5 * self.dt, value.at)
            self._add(rows, value.stamp, value.value, value.at, value.why, restart)
            self._broken = False
        if not self._coming and self._row is not None and alive is not None:
            self._fill(rows, self._row.stamp + alive - self._row.at - self.patience, math.inf)
        return rows

    @property
    def waiting(self) -> int:
        """Values of PV that are in no row yet."""
        return len(self._coming)

    def _complete(self, value: Value, now: float) -> bool:
        limit = value.stamp + SCATTER * self.dt
        return now - value.at >= self.patience or all(one.newest > limit for one in self._held.values())

    def _fill(self, rows: list[Row], limit: float, at: float) -> None:
        """Rows up to a time in which PV has not changed."""
        if not self.on_change or self._broken or self._row is None:
            return
        last = self._row
        while last.stamp + self.dt <= limit:
            self._add(rows, last.stamp + self.dt, last.pv, min(last.at + self.dt, at), last.why, restart=False)
            last = self._row

    def _add(self, rows: list[Row], stamp: float, pv: float, at: float, why: str, restart: bool) -> None:
        held = {role: one.until(stamp + SCATTER * self.dt) for role, one in self._held.items()}
        self._row = Row(stamp, pv, held, restart, at, why)
        rows.append(self._row)


def _shown(value: float) -> float | None:
    return value if math.isfinite(value) else None
