"""How far OP goes between the rows of a record: its controller acts more often than it is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.controller_rows import OTHERWISE, controller_rows
from lostmotion.identify.settled import settled_by

if TYPE_CHECKING:
    from lostmotion.identify.data import IdentificationData

# of the noise of OP. A controller with an integral leaves less than this between its rows; one that answers the slope
# of PV up to `OTHERWISE`, as the noise of every scan moves OP in full: in another simulation 0.26 to 0.44, and at most
# 0.24 without it where nothing else moved or rounded OP
MOSTLY = 0.3
# of its answer to SP that PV has given a row after the move: from the first on the loop has settled between the rows,
# if they do not show what moves OP. From the second on sizes of valves that stick are too small: by 12 to 31 % in six
# flows of tests/unit/identify/test_in_row.py with 0.15 to 0.32 of it, by 1 to 10 % in twelve with 0.11 or less
SETTLED, HIDDEN = 0.25, 0.12
# times these moves: at either end OP turns round further out than the rows show, and when is not known. In another
# simulation 27 of 70 sizes were in the interval before this, 58 of 70 are with it (docs/other-simulation.md)
FURTHER, NEARER = 2.0, 1.0
# rest from which on these moves fill a dead zone, which then seems narrower by up to so much: by 0.55 to 0.74 of them
# in five of six loops of an independent simulation with a rest of 0.06 to 0.43; one of 0.01 to 0.02 left no trace
FILLS = 0.05
FORETOLD = 1e-9  # of the range of OP: less than this its own past leaves by rounding
FILLED = 0.05  # of a dead zone: smaller moves do not make its interval wide, and nobody is told of them


@dataclass(frozen=True)
class Unseen:
    """What OP does between the rows.

    Attributes
    ----------
    moves : float
        Deviation of OP's noise where part of it lies between the rows, in units of OP; 0 where the rows show all, or
        nothing tells.
    rest : float
        Share of it that the rows of PV and SP do not explain.
    done : float
        Share of its answer to a move of SP that PV has given a row after it, where the rest is large; else 0.
    perhaps : float
        Deviation of OP's noise where OP or PV was rounded, which leaves as much of an exact controller and more than
        acts between the rows would: whether part of it lies between them is not known. Else 0.
    untold : bool
        Whether more than half of OP's noise comes from what is in no row, and SP moves too rarely to tell whether the
        loop settles between the rows.
    possible : float
        Deviation of OP's noise where it is untold: in a loop it may lie between the rows. It counts for a size that is
        told, not for what is excluded. Else 0.
    """

    moves: float = 0.0
    rest: float = 0.0
    done: float = 0.0
    perhaps: float = 0.0
    untold: bool = False
    possible: float = 0.0

    def of_size(self, sticks: bool, closed: bool) -> float:
        """The moves that count for the size of a fault that was found."""
        known = self.about(sticks) if sticks or closed else 0.0
        return max(known, self.possible) if sticks and closed else known

    def about(self, sticks: bool) -> float:
        """The moves that hide a lost motion: a valve that sticks remembers them, a dead zone is filled by them.

        Where rounding may hide that there are any, the former counts them: no size is told that they could change.
        """
        return max(self.moves, self.perhaps) if sticks else self.moves * min(self.rest / FILLS, 1.0)

    def doubted(self, end: float, moves: float, sticks: bool) -> float:
        """Upper end of a size without the moves counted in it, where it is not known whether there are any."""
        return end if self.moves > 0.0 else end - beyond_unseen(0.0, moves, sticks)

    def words(self, moves: float) -> str:
        """What is known of moves of this size in units of OP."""
        said = f"OP moves by about {moves:.2g} between the rows"
        if self.moves > 0.0:
            return f"The controller acts more often than it is recorded: {said}"
        if self.possible > 0.0:
            return f"Most of what moves OP is in no row, as where the controller acts between them: then {said}"
        return f"Rounded rows do not tell whether the controller acts more often than it is recorded: then {said}"

    @property
    def mostly(self) -> bool:
        """Whether the valve is moved by what no row shows: then the rows exclude no lost motion."""
        return self.moves > 0.0 and self.rest >= MOSTLY

    @property
    def settled(self) -> bool:
        """Whether the loop has settled before the next row: how far OP went, and came back, is in none."""
        return self.rest >= OTHERWISE

    @property
    def hides_size(self) -> bool:
        """Whether the loop does so much of its answer between the rows that a valve that sticks seems to lose less."""
        return self.done > HIDDEN


def may_be_settled(data: IdentificationData, a: FloatArray, b: FloatArray) -> bool:
    """Whether the loop may have settled before the next row, for what the record and its process B/A tell.

    A flow recorded every fifth scan, in stretches with few moves of SP, is no different in its rows from a loop that
    somebody else moves: 0.5 to 0.8 % of span were excluded where 2 % is lost. But its process has given a quarter of
    its answer and more within a row.
    """
    level = float(b.sum()) / max(1.0 + float(a.sum()), 1e-12)
    return data.unseen.untold and abs(float(b[0])) > SETTLED * abs(level)


def unseen_moves(data: IdentificationData) -> Unseen:
    """What OP does between the rows, from what its controller leaves of it in the rows.

    A controller that acts once a row makes OP an exact function of PV, SP and its own past in the rows. One that acts
    several times leaves a small rest, the integral of a noise of PV that is in no row; then OP turns round between rows
    as well, further out by about its noise, and a valve with a memory has been there.
    """
    found = controller_rows(data)
    if found is None or found.own <= FORETOLD * float(np.ptp(data.u)) or found.exact:
        return Unseen()
    if found.rounded:
        return Unseen(perhaps=found.own)
    rest = found.left / found.own
    done = settled_by(data.y, data.sp, data.segments) if rest >= MOSTLY else 0.0
    if rest < OTHERWISE or done > SETTLED:
        return Unseen(found.own, rest, done)
    untold = data.sp is not None and done == 0.0
    return Unseen(untold=untold, possible=found.own if untold else 0.0)


def beyond_unseen(size: float, moves: float, sticks: bool = True) -> float:
    """Upper end of the size of a lost motion, where OP moves so between the rows; a valve that sticks remembers it."""
    return size + (FURTHER if sticks else 1.0) * moves


def within_unseen(size: float, moves: float, sticks: bool = True) -> float:
    """Lower end of the same."""
    return max(size - NEARER * moves, 0.0) if moves > 0.0 and sticks else size
