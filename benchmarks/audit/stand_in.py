"""A plant that costs nothing: made records, and a screen and an assessment of some milliseconds.

For what is about the machinery and not about valves: resuming, engines, stores. Tags say what happens to a loop:
"kill" ends the worker that looks at it, "raise" raises, "bad" cannot be read, "endless" and "asleep" never come back.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

from lostmotion.audit.runner.work import Steps
from lostmotion.audit.settings import AuditSettings
from lostmotion.errors import DataError, LostMotionError
from lostmotion.plant import PlantLoop, Unread
from lostmotion.records import LoopRecord
from lostmotion.store.rows import AssessmentRow, GroupRow, SpectrumRow, Stage, TraceRow

BEGAN = datetime(2026, 3, 1, tzinfo=UTC)
HERE = "benchmarks.audit.stand_in"
STEPS = Steps(f"{HERE}:windows_of", f"{HERE}:screen", f"{HERE}:assess", f"{HERE}:ranked", f"{HERE}:groups")
VERDICTS = ("none", "stiction", "dead zone", "backlash", "cannot tell", "other oscillation")
SEVERITIES = ("none", "low", "moderate", "high", "severe")


@dataclass(frozen=True)
class Window:
    """As the audit has it."""

    start: datetime
    end: datetime
    record: LoopRecord


@dataclass(frozen=True)
class MadePlant:
    """Loops whose records are made when they are read.

    Attributes
    ----------
    tags : tuple of str
    rows : int
    stamp : str
        Of all loops.
    data : int
        Seed: another one, another record.
    log : str
        File in which a line is written for each loop that is read.
    cost : float
        Processor seconds of an assessment; a tenth of it of a screen.
    """

    tags: tuple[str, ...]
    rows: int = 240
    stamp: str = "1"
    data: int = 0
    log: str = ""
    cost: float = 0.0

    def loops(self) -> tuple[PlantLoop, ...]:
        """Four loops a file."""
        return tuple(
            PlantLoop(
                tag, where=f"file{number // 4}.csv#{tag}", area=f"area {number % 3}", stamp=self.stamp, size=2000,
                weight=1.0 + number % 5, loop_type=str(self.cost),
            )
            for number, tag in enumerate(self.tags)
        )  # fmt: skip

    def unread(self) -> tuple[Unread, ...]:
        """A text and a broken file."""
        return Unread("README.md", "a text", failed=False), Unread("broken.csv", "no table")

    def read(
        self,
        loops: Sequence[PlantLoop],
        since: datetime | None = None,  # noqa: ARG002
        until: datetime | None = None,  # noqa: ARG002
    ) -> Iterator[tuple[PlantLoop, LoopRecord | LostMotionError]]:
        """The same record of a loop in every process."""
        for loop in loops:
            if self.log:
                with Path(self.log).open("a", encoding="utf-8") as file:
                    file.write(f"{loop.tag}\n")
            if loop.tag.startswith("bad"):
                yield loop, DataError.expected("a table", "noise", "look at the file")
                continue
            yield loop, self._record(loop)

    def _record(self, loop: PlantLoop) -> LoopRecord:
        made = np.random.default_rng([self.data, *loop.tag.encode()])
        op = np.cumsum(made.normal(size=self.rows))
        return LoopRecord(op, np.roll(op, 3) + made.normal(size=self.rows), dt=60.0, tag=loop.tag, start=BEGAN)


def windows_of(record: LoopRecord, settings: AuditSettings) -> Iterator[Window]:
    """Whole, or pieces."""
    length = len(record) if settings.window is None else max(int(settings.window / record.dt), 2)
    for first in range(0, len(record) - 1, length):
        start = BEGAN + timedelta(seconds=first * record.dt)
        part = record.cut(first, first + length)
        yield Window(start, start + timedelta(seconds=len(part) * record.dt), part)


def screen(
    loop: PlantLoop,
    record: LoopRecord,
    start: datetime,
    end: datetime,
    settings: AuditSettings,  # noqa: ARG001
) -> tuple[AssessmentRow, SpectrumRow | None]:
    """Some numbers of the record."""
    if loop.tag.startswith("kill"):
        os.kill(os.getpid(), signal.SIGKILL)
    if loop.tag.startswith("raise"):
        raise ZeroDivisionError("in\nthe screen")
    began = time.process_time()
    busy(loop, 0.1)
    value = float(np.abs(np.corrcoef(record.op, record.pv)[0, 1]))
    row = AssessmentRow(
        loop.tag, start, end, fingerprint=record.fingerprint, reason="swings", rows=len(record), dt=record.dt,
        value=value if value > 0.3 else 0.0, travel=float(np.abs(np.diff(record.op)).sum()), period=float("nan"),
        health=("stale for 3 % of the time",), indices={"mean": float(record.op.mean())},
    )  # fmt: skip
    power = np.abs(np.fft.rfft(record.pv - record.pv.mean(), 192))[:96].astype("<f4")
    return replace(row, seconds=time.process_time() - began), SpectrumRow(loop.tag, start, 1e-4, 8e-3, power.tobytes())


def assess(
    loop: PlantLoop,
    record: LoopRecord,
    row: AssessmentRow,
    settings: AuditSettings,  # noqa: ARG001
) -> tuple[AssessmentRow, TraceRow | None]:
    """Some more numbers."""
    if loop.tag.startswith("late kill"):
        os.kill(os.getpid(), signal.SIGKILL)
    if loop.tag.startswith("late raise"):
        raise ValueError("in the assessment")
    while loop.tag.startswith("endless"):
        pass
    if loop.tag.startswith("asleep"):  # as compiled code that never comes back: nothing interrupts it
        time.sleep(1e6)
    began = time.process_time()
    busy(loop, 1.0)
    size = float(np.std(record.op - record.pv))
    which = int(1e3 * size) % len(VERDICTS)
    new = replace(
        row, stage=Stage.ASSESSED, verdict=VERDICTS[which], severity=SEVERITIES[which % 5], size=size, low=0.5 * size,
        high=float("inf"), confidence=row.value, status="OK", kind="actuator" if which in (1, 2, 3) else "none",
        evidence=(("shape", size, -0.0),), advice=("Test the valve.",), seconds=time.process_time() - began,
    )  # fmt: skip
    op, pv = record.op[:100].astype("<f4"), record.pv[:100].astype("<f4")
    return new, TraceRow(loop.tag, row.window_start, 0.0, 6000.0, b"", pv.tobytes(), op.tobytes(), "{}")


def busy(loop: PlantLoop, share: float) -> None:
    """Take processor time: the cost of the plant stands in the type of the loop, where workers see it."""
    until = time.process_time() + share * float(loop.loop_type or 0.0)
    while time.process_time() < until:
        np.linalg.svd(np.ones((30, 30)))


def ranked(
    rows: Sequence[AssessmentRow], loops: dict[str, PlantLoop], _: Sequence[GroupRow] = ()
) -> list[AssessmentRow]:
    """By size and weight."""
    return [
        replace(row, label="normal", split=row.kind, priority=row.size and row.size * loops[row.tag].weight,
                priority_reason="by size")
        for row in rows
    ]  # fmt: skip


def groups(
    spectra: Sequence[SpectrumRow],
    rows: Sequence[AssessmentRow],  # noqa: ARG001
    loops: Mapping[str, PlantLoop],  # noqa: ARG001
) -> tuple[GroupRow, ...]:
    """Threes, in the order of the spectra."""
    threes = [spectra[first : first + 3] for first in range(0, len(spectra) - 2, 3)]
    return tuple(
        GroupRow(number, 60.0 * number, three[0].tag, None, "first",
                 tuple((one.tag, one.window_start, 0.9, float(one.power[0])) for one in three))
        for number, three in enumerate(threes, 1)
    )  # fmt: skip
