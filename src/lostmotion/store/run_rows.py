"""Rows of the store beside the results: loops, runs, watches, what could not be read, reviews."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum


@dataclass(frozen=True)
class LoopRow:
    """A loop as the store knows it: the last that a loop list said about it.

    Attributes are those of :class:`lostmotion.plant.PlantLoop`, but for its size and stamp.
    """

    tag: str
    area: str = ""
    loop_type: str = ""
    op: str = ""
    pv: str = ""
    sp: str = ""
    mode: str = ""
    op_span: tuple[float, float] | None = None
    pv_span: tuple[float, float] | None = None
    op_unit: str = ""
    pv_unit: str = ""
    weight: float = 1.0
    where: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class UnreadRow:
    """Something of a source that gives no loop.

    Attributes
    ----------
    where, why : str
    failed : bool
        False: it holds no loop's data by its nature.
    """

    where: str
    why: str
    failed: bool = True


class RunState(StrEnum):
    """How a run stands."""

    RUNNING = "running"  # or killed: its heartbeat tells
    STOPPED = "stopped"  # by Ctrl-C or an error; the same command goes on with it
    FINISHED = "finished"
    ABANDONED = "abandoned"  # was never finished, and another one was begun since


@dataclass(frozen=True)
class RunRow:
    """One audit of one source.

    Attributes
    ----------
    source : str
        What was audited, in words.
    settings : str
        JSON of the settings.
    digest : str
        Of those that decide.
    code : str
        Version of the code that decides.
    since, until : datetime, optional
    screen_only : bool
    engine : str
    workers : int
    state : RunState
    began, heartbeat, ended : datetime, optional
        UTC.
    note : str
        Why it stopped; empty: it did not.
    number : int
        From 1, in the order in which they began.
    """

    source: str
    settings: str = "{}"
    digest: str = ""
    code: str = ""
    since: datetime | None = None
    until: datetime | None = None
    screen_only: bool = False
    engine: str = ""
    workers: int = 1
    state: RunState = RunState.RUNNING
    began: datetime | None = None
    heartbeat: datetime | None = None
    ended: datetime | None = None
    note: str = ""
    number: int = 0


@dataclass(frozen=True)
class WatchRow:
    """Loops of a running plant that one process watches: no audit, and never taken for one.

    Attributes
    ----------
    source : str
        Address of the server, without password.
    tags : tuple of str
        Loops that are watched.
    digest : str
        Of the settings of the estimators.
    state : RunState
        Never finished: stopped until it goes on.
    began, heartbeat, ended : datetime, optional
        UTC.
    note : str
        Why it stopped; empty: it did not, or by hand.
    number : int
        From 1, in the order in which they began.
    """

    source: str
    tags: tuple[str, ...] = ()
    digest: str = ""
    state: RunState = RunState.RUNNING
    began: datetime | None = None
    heartbeat: datetime | None = None
    ended: datetime | None = None
    note: str = ""
    number: int = 0


class ReviewState(StrEnum):
    """What people have decided about a finding."""

    NEW = "new"
    ACCEPTED = "accepted"
    REJECTED = "rejected"
    WORK_ORDER = "work order"
    REPAIRED = "repaired"


@dataclass(frozen=True)
class ReviewRow:
    """What somebody has decided about a loop, and when.

    Attributes
    ----------
    tag : str
    state : ReviewState
    who : str
    at : datetime
        UTC.
    note : str
    """

    tag: str
    state: ReviewState
    who: str
    at: datetime
    note: str = ""
