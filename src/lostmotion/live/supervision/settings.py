"""``[loop.block]`` and ``[supervision]`` of a plant file: which blocks may be asked for other widths, and how."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from lostmotion.compensate.supervised import SupervisedBlock
from lostmotion.errors import DataError, InputError
from lostmotion.files.results import read_json
from lostmotion.files.schema import Check, either, flag, group, number, row, table, text
from lostmotion.live.opcua.plc_link import nodes_of
from lostmotion.simulate import PI

DEAD_ZONE = "dead zone"
SAME = 1e-9  # share by which the sampling time may differ from the scan time of the block
REMEDY = "use the .._supervisor.json that export --supervised wrote"
BESIDE = "docs/supervised.md says what [loop.block] holds"

_word = text(1000)
STUDY: dict[str, Check] = {
    "sp_step": number(), "hold": number(1e-12, 1e12), "op_now": number(), "span": row(number(), number()),
}  # fmt: skip
BLOCK = group(
    {
        "write": flag(), "name": _word, "adaptive": flag(), "who": _word, "precision": number(1e-6, 1.0),
        "least_interval": number(1.0, 1e9), "least_change": number(0.0, 1e12), **STUDY,
    },
    file=_word, nodes=either(_word, table(_word, 100)), kp=number(), ki=number(),
)  # fmt: skip
SUPERVISION = group({"requests": _word}, log=_word)


@dataclass(frozen=True)
class BlockSettings:
    """A block in the PLC that may be asked for other widths.

    Attributes
    ----------
    tag : str
        Of its loop.
    name : str
        Of the block, for the log; the tag where nothing else is said.
    block : SupervisedBlock
        As it was commissioned.
    nodes : dict of str
        Node id of each input and output.
    controller : PI
        Gains of the loop's controller, for the study.
    write : bool
        The word of the file; nothing is written without the one of the command as well.
    adaptive : bool
        Ask by the online estimate; False: only what a person asks for.
    who : str
        In whose name the estimate asks.
    precision : float
        Largest half-width of the 95 % interval of a break point, as a share of the width.
    least_interval : float
        Seconds from one attempt to the next.
    least_change : float
        Units of OP, from which on a width is asked to change.
    study : dict
        sp_step, hold, op_now, span of :func:`lostmotion.compensation_study`.
    """

    tag: str
    name: str
    block: SupervisedBlock
    nodes: dict[str, str]
    controller: PI
    write: bool = False
    adaptive: bool = False
    who: str = "live"
    precision: float = 0.15
    least_interval: float = 3600.0
    least_change: float = 0.0
    study: dict[str, Any] = field(default_factory=dict)

    @property
    def timeout(self) -> float:
        """Seconds without a heartbeat, after which the block sheds."""
        return self.block.settings["timeout"] * self.block.scan_time


@dataclass(frozen=True)
class Supervision:
    """What the blocks of a plant have in common.

    Attributes
    ----------
    log : Path
        A line for everything that is asked of a PLC.
    requests : Path or None
        Folder in which a person's request is handed over; None: only estimates ask.
    """

    log: Path
    requests: Path | None = None


def supervision_of(content: Mapping[str, Any], folder: Path, name: str) -> Supervision | None:
    """``[supervision]`` of a plant file; needed where a loop has ``write = true``."""
    said = content.get("supervision")
    if said is None:
        if any(loop.get("block", {}).get("write") for loop in content["loop"]):
            got = "write = true and no [supervision]"
            raise DataError.expected(f'[supervision] with log = ".." in {name}', got, "say where the log shall be")
        return None
    return Supervision(folder / said["log"], folder / said["requests"] if "requests" in said else None)


def block_of(loop: Mapping[str, Any], folder: Path) -> BlockSettings | None:
    """``[loop.block]`` of a loop; None where it has none.

    Raises
    ------
    FileAccessError
        The file of the block cannot be read.
    DataError
        It holds no supervised block; what goes to the valve is not what is watched; `adaptive` beside a kind that no
        estimator follows.
    """
    said = loop.get("block")
    if said is None:
        return None
    tag, path = str(loop["tag"]), folder / said["file"]
    block = _saved(path)
    nodes = nodes_of(block, said["nodes"]) if isinstance(said["nodes"], str) else dict(said["nodes"])
    _refuse_names(tag, block, nodes)
    if loop["op"] != nodes["op_out"]:
        remedy = "the estimate must see what goes to the valve, behind the block"
        raise DataError.expected(f"op = {nodes['op_out']!r} in loop {tag!r}", repr(loop["op"]), remedy)
    if said.get("adaptive", False) and block.kind != DEAD_ZONE:
        remedy = "ask with `lostmotion request`, from a fit"
        raise DataError.expected(f"adaptive beside a block for a {DEAD_ZONE} in loop {tag!r}", block.kind, remedy)
    names = ("name", "write", "adaptive", "who", "precision", "least_interval", "least_change")
    given: dict[str, Any] = {key: said[key] for key in names if key in said}
    study = {key: tuple(said[key]) if key == "span" else said[key] for key in STUDY if key in said}
    whole = {"tag": tag, "name": tag, **given}
    return BlockSettings(**whole, block=block, nodes=nodes, controller=PI(said["kp"], said["ki"]), study=study)


def _saved(path: Path) -> SupervisedBlock:
    """Block of the file that was exported beside the code of the PLC."""
    data = read_json(path, "a supervised block", REMEDY)
    if "supervision" not in data:
        raise DataError.expected("the JSON of a supervised block", f"{path} without supervision", REMEDY)
    try:
        return SupervisedBlock.from_dict(data)
    except (InputError, TypeError, ValueError, AttributeError) as error:
        got = f"{path}: {str(error)[:200]}"
        raise DataError.expected("the JSON of a supervised block", got, REMEDY) from error


def _refuse_names(tag: str, block: SupervisedBlock, nodes: Mapping[str, str]) -> None:
    known = nodes_of(block, "")
    for name in known:
        if name not in nodes:
            raise DataError.expected(f"a node for {name} of the block of {tag!r}", "none", BESIDE)
    odd = sorted(set(nodes) - set(known))
    if odd:
        raise DataError.expected(f"inputs and outputs of the block of {tag!r}", odd[0], BESIDE)


def refuse_other_scan(settings: BlockSettings, dt: float) -> None:
    """A study runs the block at the sampling time of the estimate: both must be one.

    Raises
    ------
    DataError
        They are not.
    """
    scan = settings.block.scan_time
    if abs(scan - dt) > SAME * scan:
        remedy = "sample the loop at the scan of its block, or export the block for this scan time"
        raise DataError.expected(f"dt = {scan:g} s, the scan of the block of {settings.tag!r}", f"{dt:g} s", remedy)
