"""A server and its loops in service, from settings to the end."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass
from datetime import UTC, datetime
from hashlib import sha256
from pathlib import Path
from threading import Event, Lock
from typing import TYPE_CHECKING, Any

from asyncua import ua

from lostmotion.files.tag_file import tag_file
from lostmotion.files.writer import refuse_folder
from lostmotion.live.first_fits import FirstFits
from lostmotion.live.loop_settings import LoopSettings, Model, publishing_of
from lostmotion.live.loop_source import LoopSource, check_position
from lostmotion.live.opcua.data_value import quality_of, value_of
from lostmotion.live.opcua.link import Connect, Followed, Link
from lostmotion.live.recorder import LARGEST, PIECE, Recorder
from lostmotion.live.run import Plant, Watched
from lostmotion.online.service import Kept, Service, at_once
from lostmotion.store.alive import BEAT
from lostmotion.store.run_rows import LoopRow, WatchRow

if TYPE_CHECKING:
    from lostmotion.live.estimates import Estimates

FEW = 10  # loops whose first fits, all at once, last a second: more have a process for them

STORED = 2.0  # s after which an estimate is written

Emit = Callable[[dict[str, Any]], None]


@dataclass(frozen=True)
class Kinds:
    """Where things are kept: folders that are there, and the address of a store; or None.

    Attributes
    ----------
    state, record : Path, optional
    store : str, optional
    source : str
        Address of the server, as the store shall name it.
    """

    state: Path | None = None
    record: Path | None = None
    store: str | None = None
    source: str = ""


class Watch:
    """Loops of a server, ready to run.

    Parameters
    ----------
    loops : sequence of LoopSettings
    connect : callable
        Gives a client with an open session.
    emit : callable
        Takes each message, a JSON-ready dictionary with the tag of its loop; one at a time.
    kept : Kinds

    Raises
    ------
    LostMotionError
        A gate is closed, a state is of other settings or held by another process, a folder cannot be made.
    """

    def __init__(self, loops: Sequence[LoopSettings], connect: Connect, emit: Emit, kept: Kinds | None = None) -> None:
        self._emit, self._lock = emit, Lock()
        where = kept or Kinds()
        if where.state is not None:
            refuse_folder(where.state, ())
        models = [loop.model() for loop in loops]
        publishing = publishing_of([model.dt for model in models])
        self.recorder = None if where.record is None else Recorder(where.record)
        self.estimates: Estimates | None = None
        self._open = ExitStack()
        self.watched: list[Watched] = []
        followed = []
        try:
            for loop, model in zip(loops, models, strict=True):
                one = self._watched(loop, model, publishing, where.state)
                self.watched.append(one)
                followed.append(Followed(one.source, loop.automatic, loop.uncertain))
            if where.store is not None:
                self.estimates = self._estimates(where.store, where.source, loops, models)
                self._open.callback(self.estimates.close)
        except BaseException:
            self._open.close()
            raise
        taps = () if self.recorder is None else (self._record,)
        self.link = Link(connect, followed, publishing, self._tell, taps)
        for loop, model in zip(loops, models, strict=True):
            if model.accepted:
                self._tell("note", loop.tag, f"ACCEPTED behind a closed gate: {model.accepted}.")

    def _watched(self, loop: LoopSettings, model: Model, publishing: float, folder: Path | None) -> Watched:
        path = None if folder is None else folder / tag_file(loop.tag, ".state")
        settings = json.loads(json.dumps({**model.settings, **loop.watch}))
        kept = self._open.enter_context(Kept(path, settings, check_position))
        source = LoopSource(model.signals(loop, publishing), kept.position)

        def emit(message: dict[str, Any]) -> None:
            self._said({"tag": loop.tag, **message})

        return Watched(source, Service(source, kept, model.maker(loop), emit, loop.width_limit))

    def _estimates(self, store: str, source: str, loops: Sequence[LoopSettings], models: Sequence[Model]) -> Estimates:
        from lostmotion.live.estimates import Estimates  # noqa: PLC0415  databases come with lostmotion[audit]

        said = {loop.tag: {**model.settings, **loop.watch} for loop, model in zip(loops, models, strict=True)}
        digest = sha256(json.dumps(said, sort_keys=True, default=str).encode()).hexdigest()
        rows = [
            LoopRow(one.tag, op=of["op"], pv=of["pv"], sp=of.get("sp", ""), mode=of.get("mode", ""), where=source)
            for one in loops
            for of in [one.nodes]
        ]
        wanted = WatchRow(source, tuple(loop.tag for loop in loops), digest)
        return Estimates(store, wanted, rows, lambda message: self._tell("store", "", message))

    def meet(self) -> None:
        """See :meth:`Link.meet`; what was opened is closed where the server is not believed."""
        try:
            asyncio.run(self.link.meet())
        except BaseException:
            self._open.close()
            raise

    async def run(self, stop: Event) -> bool:
        """Work until `stop` is set; whether any loop could go on until then."""
        try:
            if self.estimates is not None:
                self.estimates.begin()  # what is compiled may have taken longer than a heart may be silent
            with FirstFits() if len(self.watched) > FEW else nullcontext() as fits:
                await Plant(self.watched, self._work(), fits.take if fits else at_once).run(stop)
        finally:
            self._open.close()
            if self.recorder is not None:
                self.recorder.write()
        return any(one.failure is None for one in self.watched)

    async def _work(self) -> None:
        try:
            async with asyncio.TaskGroup() as group:
                group.create_task(self.link.run())
                if self.recorder is not None:
                    group.create_task(self._pieces(self.recorder))
                if self.estimates is not None:
                    group.create_task(self._stored(self.estimates))
        except BaseExceptionGroup as found:
            raise found.exceptions[0] from None  # one line for a person

    async def _stored(self, estimates: Estimates) -> None:
        """Soon after a report, so that a kill loses little, and with each beat of the heart."""
        written = 0.0
        while True:
            await asyncio.sleep(STORED)
            if estimates.waiting or time.monotonic() - written > BEAT:
                await asyncio.to_thread(estimates.write)
                written = time.monotonic()

    async def _pieces(self, recorder: Recorder) -> None:
        """A piece each minute, or as soon as there is enough for one."""
        waited = 0
        while True:
            await asyncio.sleep(1.0)
            waited += 1
            if waited >= PIECE or len(recorder) > LARGEST:
                waited = 0
                await asyncio.to_thread(recorder.write)

    def _record(self, loop: Followed, role: str, data: ua.DataValue) -> None:
        value = value_of(role, data, 0.0, loop.automatic, "keep")
        if value is not None and self.recorder is not None:
            self.recorder.add(value.stamp, f"{loop.source.name}.{role.upper()}", value.value, quality_of(data))

    def _tell(self, kind: str, tag: str, message: str) -> None:
        when = datetime.now(UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
        self._said({"tag": tag, "kind": kind, "time": when, "message": message})

    def _said(self, message: dict[str, Any]) -> None:
        with self._lock:
            self._emit(message)
        if self.estimates is not None:
            self.estimates.take(message)
