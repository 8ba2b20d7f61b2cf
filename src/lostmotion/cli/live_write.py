"""``lostmotion live --write``: which blocks are supervised, and where their messages go."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from typing import TYPE_CHECKING, Annotated, Any

import typer

from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from lostmotion.live.opcua.link import Connect
    from lostmotion.live.plant_file import PlantFile
    from lostmotion.live.supervision.plant import Supervised

Write = Annotated[
    bool, typer.Option("--write", help="Supervise the blocks with write = true in the plant file: docs/supervised.md.")
]
Emit = Callable[[dict[str, Any]], None]


def one_at_a_time(emit: Emit) -> Emit:
    """The same for several threads."""
    lock = Lock()

    def emitted(message: dict[str, Any]) -> None:
        with lock:
            emit(message)

    return emitted


def supervised(plant: PlantFile | None, connect: Connect, emit: Emit, write: bool) -> Supervised | None:
    """The blocks that may be written to: None without the word of the command, and a word about that of the file.

    Raises
    ------
    ParameterError
        ``--write`` without a loop that has ``write = true``.
    """
    from lostmotion.live.supervision.plant import SILENT, Supervised

    if not write:
        for block in plant.blocks if plant is not None else ():
            if block.write:
                emit({"tag": block.tag, "kind": "note", "message": SILENT})
        return None
    if plant is None:
        got = "an address"
        raise ParameterError.expected("a plant file beside --write", got, "say there which block may be written to")
    return Supervised(plant, connect, emit)
