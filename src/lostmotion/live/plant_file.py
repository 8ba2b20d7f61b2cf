"""``plant.toml``: the server and its loops, said once and checked before anything is connected."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError, one_line
from lostmotion.files.frames import read_bytes
from lostmotion.files.schema import (
    anything,
    checked,
    each,
    either,
    flag,
    group,
    number,
    one_of,
    row,
    table,
    text,
    toml_of,
    whole,
)
from lostmotion.live.loop_settings import LoopSettings
from lostmotion.live.supervision.settings import (
    BLOCK,
    SUPERVISION,
    BlockSettings,
    Supervision,
    block_of,
    supervision_of,
)

MOST_LOOPS = 10_000
REMEDY = "correct it; docs/live.md says what it holds"
SECRETS = ("password", "passwd", "secret", "token", "private")
WATCH = ("report_every", "trend_every", "op_limits", "frozen")
PATHS = ("fit", "diagnosis")

_word, _positive = text(1000), number(1e-12, 1e12)
SETTINGS = {
    "dt": _positive, "fit": _word, "diagnosis": _word, "orders": row(whole(0, 50), whole(0, 50), whole(0, 10_000)),
    "gain": number(), "noise": either(one_of("auto", "white"), whole(0, 50)), "forgetting": number(0.5, 1.0),
    "start_samples": whole(50, 10_000_000), "accept": _word, "width_limit": _positive,
    "automatic": each(_word, 100), "uncertain": one_of("bad", "keep"), "on_change": flag(),
    "report_every": whole(1), "trend_every": whole(1), "op_limits": row(number(), number()), "frozen": whole(2),
}  # fmt: skip
LOOP = group({**SETTINGS, "sp": _word, "mode": _word, "block": BLOCK}, tag=_word, op=_word, pv=_word)
FILE = group(
    {"defaults": group(SETTINGS), "security": table(anything), "supervision": SUPERVISION},
    address=_word, loop=each(LOOP, MOST_LOOPS, 1),
)  # fmt: skip


@dataclass(frozen=True)
class PlantFile:
    """A server and its loops.

    Attributes
    ----------
    address : str
        ``opc.tcp://host:port``.
    loops : tuple of LoopSettings
    security : dict
        As it stands; who connects looks at it.
    blocks : tuple of BlockSettings
        Of the loops that have one in the PLC.
    supervision : Supervision or None
    """

    address: str
    loops: tuple[LoopSettings, ...]
    security: dict[str, Any]
    blocks: tuple[BlockSettings, ...] = ()
    supervision: Supervision | None = None


def read_plant_file(path: Path) -> PlantFile:
    """Plant of a file; paths in it count from its folder.

    Raises
    ------
    FileAccessError
        It cannot be read.
    DataError
        No TOML, something missing or unknown, a tag twice, or a secret in it: each with its place.
    """
    data = read_bytes(path)
    try:
        content = toml_of(data.decode("utf-8"))
    except ValueError as error:
        raise DataError.expected(f"TOML in {path.name}", one_line(str(error))[:300], "correct it") from error
    return plant_of(content, path.parent, path.name)


def plant_of(content: Mapping[str, Any], folder: Path, name: str = "the plant file") -> PlantFile:
    """Plant of what a file holds; errors as :func:`read_plant_file`.

    Examples
    --------
    >>> loop = {"tag": "FIC1", "op": "ns=2;s=FIC1.OP", "pv": "ns=2;s=FIC1.PV", "orders": [1, 0, 1], "dt": 1.0}
    >>> plant_of({"address": "opc.tcp://plc:4840", "loop": [loop]}, Path(".")).loops[0].orders
    (1, 0, 1)
    """
    _refuse_secrets(content, name)
    checked(content, FILE, name, REMEDY)
    defaults = content.get("defaults", {})
    loops = tuple(_loop({**defaults, **one}, folder) for one in content["loop"])
    twice = [tag for tag, count in Counter(loop.tag for loop in loops).items() if count > 1]
    if twice:
        raise DataError.expected(f"each tag once in {name}", f"{twice[0]!r} twice", "rename one")
    blocks = tuple(block for one in content["loop"] if (block := block_of(one, folder)) is not None)
    supervision = supervision_of(content, folder, name)
    return PlantFile(content["address"], loops, dict(content.get("security", {})), blocks, supervision)


def _loop(one: Mapping[str, Any], folder: Path) -> LoopSettings:
    nodes = {role: one[role] for role in ("op", "pv", "sp", "mode") if role in one}
    known = {field.name for field in fields(LoopSettings)} - {"watch", "nodes"}
    given: dict[str, Any] = {key: _fixed(value) for key, value in one.items() if key in known}
    given |= {key: folder / given[key] for key in PATHS if key in given}
    watch = {key: _fixed(one[key]) for key in WATCH if key in one}
    return LoopSettings(nodes=nodes, watch=watch, **given)


def _fixed(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _refuse_secrets(content: Any, name: str) -> None:
    """No key of the file may be one for a secret: such files are copied and shown."""
    if isinstance(content, list):
        for one in content:
            _refuse_secrets(one, name)
    if isinstance(content, Mapping):
        for key, value in content.items():
            words = str(key).lower()
            if any(word in words for word in SECRETS) and not words.endswith(("_file", "_variable", "_env")):
                raise DataError.expected(f"no secret in {name}", f"a key {key!r}", "name a file or a variable for it")
            _refuse_secrets(value, name)
