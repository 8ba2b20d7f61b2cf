"""All blocks of a plant under supervision: one log, one door, a thread each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any

from lostmotion.errors import LostMotionError, ParameterError
from lostmotion.files.writer import lock_file
from lostmotion.live.link import Link
from lostmotion.live.opcua.link import Connect
from lostmotion.live.opcua.plc_link import PlcLink
from lostmotion.live.plant_file import PlantFile
from lostmotion.live.run import Watched
from lostmotion.live.supervision.handed_over import Inbox
from lostmotion.live.supervision.said import Emit, ToldLog
from lostmotion.live.supervision.settings import BlockSettings, Supervision, refuse_other_scan
from lostmotion.live.supervision.writer import BlockWriter

SILENT = "write = true is of no effect without --write: nothing is written, not even a heartbeat."


class Supervised:
    """Blocks with both words, that of the file and that of the command.

    Parameters
    ----------
    plant : PlantFile
    connect : callable
        Gives a client with an open session, as for reading.
    emit : callable
        Takes messages, from any thread.

    Raises
    ------
    ParameterError
        No loop has ``write = true``.
    DataError
        The sampling time of a loop is not the scan of its block.
    """

    def __init__(self, plant: PlantFile, connect: Connect, emit: Emit) -> None:
        chosen = [block for block in plant.blocks if block.write]
        if not chosen or plant.supervision is None:
            raise ParameterError.expected("write = true in [loop.block] of a loop", "none", "leave out --write")
        times = {loop.tag: loop.model().dt for loop in plant.loops}
        for block in chosen:
            refuse_other_scan(block, times[block.tag])
        self._common: Supervision = plant.supervision
        self._blocks, self._connect, self._emit = chosen, connect, emit
        self.writers: dict[str, BlockWriter] = {}

    @property
    def failed(self) -> bool:
        """Whether a supervisor had to end by itself."""
        return any(writer.failed for writer in self.writers.values())

    @contextmanager
    def at_work(self, watched: Sequence[Watched]) -> Iterator[None]:
        """Beat and ask until the end, and listen to the estimates of the loops.

        Raises
        ------
        FileAccessError
            Another process writes this log, or it cannot be written; the folder of requests is open to everybody.
        """
        with ExitStack() as open_:
            open_.enter_context(lock_file(self._common.log))  # two supervisors of one block must not be
            log = ToldLog(self._common.log, {one.name: one.tag for one in self._blocks}, self._emit)
            for block in self._blocks:
                log.line(who=block.name, block=block.name, event="start", answer="live --write begins, write = true")
            inbox = None if self._common.requests is None else self._inbox(open_, log)
            for block in self._blocks:
                self.writers[block.tag] = BlockWriter(block, self._opener(block), log, self._emit, inbox)
            for one in watched:
                if one.source.name in self.writers:
                    _listen(one, self.writers[one.source.name])
            for writer in self.writers.values():
                writer.start()
            try:
                yield
            finally:
                self._stop()

    def _inbox(self, open_: ExitStack, log: ToldLog) -> Inbox:
        assert self._common.requests is not None  # noqa: S101  asked before
        inbox = Inbox(self._common.requests, [block.tag for block in self._blocks])
        for name in open_.enter_context(inbox.open()):
            log.line(who="a person", block="", event="not asked", answer=f"{name} was found at the start: thrown away")
        return inbox

    def _opener(self, block: BlockSettings) -> Any:
        def opened() -> Link:
            return PlcLink.over(self._connect, block.nodes)

        return opened

    def _stop(self) -> None:
        """All at once: each may wait for an answer."""
        for writer in self.writers.values():
            writer.end()
        for writer in self.writers.values():
            writer.wait()


def _listen(watched: Watched, writer: BlockWriter) -> None:
    """Hand each estimate that is reported to the writer; in the thread of the loop's turn, which alone may read it."""
    service, emit = watched.service, watched.service.emit

    def heard(message: Mapping[str, Any]) -> None:
        emit(dict(message))
        if message["kind"] == "report" and message["status"] == "OK" and service.monitor is not None:
            try:
                writer.heard(service.monitor.estimator.estimate)
            except LostMotionError:  # one outside the valid set: the report has said so
                return

    service.emit = heard
