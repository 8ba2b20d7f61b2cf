"""propose: a loop list from names, ISA-5.1 letters and the data, for a person to correct."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import LostMotionError
from lostmotion.files.hints import likely
from lostmotion.files.joined import path_stem
from lostmotion.files.tags import loop_type
from lostmotion.plant.address import Place, written
from lostmotion.plant.cascades import Cascades
from lostmotion.plant.files_source import FilesSource
from lostmotion.plant.loop import PlantLoop
from lostmotion.plant.loop_list import in_loop_list
from lostmotion.plant.source import PlantSource
from lostmotion.plant.survey import below
from lostmotion.records.record import LoopRecord
from lostmotion.records.span import FRACTION, possible_spans

NO_PV_SPAN = "PV limits are not in the data: fill in pv_low and pv_high, else a noisy measurement is not told."
Begun = dict[bytes, list[tuple[str, FloatArray]]]
BATCH = 64  # loops that are read together
COMPARED = 200  # first values by which two records are taken for the same
KEYED = 12  # of them that lead to the records to compare with
NEAR = 1e-3  # of the deviation of a signal: what exports of different digits differ by
UNIT_TYPES = {
    "flow": ("m3/h", "m³/h", "l/h", "l/min", "t/h", "kg/h", "kg/s", "gpm", "lpm", "nm3/h", "sm3/h", "scfm", "scfh",
             "kscfh", "mmscfd", "bbl/d", "bpd", "m3/d", "t/d", "lb/h", "klb/h", "l/s", "m3/s"),
    "pressure": ("bar", "barg", "bara", "mbar", "pa", "kpa", "mpa", "psi", "psig", "psia", "inh2o", "mmh2o", "mmhg"),
    "temperature": ("degc", "degf", "°c", "°f"),
    "level": ("m", "mm", "cm"),
}  # fmt: skip


def propose(source: PlantSource, progress: Callable[[int, int], None] | None = None) -> tuple[PlantLoop, ...]:
    """Loops of a source with what their data say: limits of OP, units, types; remarks say what was inferred.

    Parameters
    ----------
    source : PlantSource
        Its data are read, a few loops at a time.
    progress : callable, optional
        Called with the number of loops done and their total.

    Returns
    -------
    tuple of PlantLoop
        In the order of the source; then a guess for each file whose columns are not told by their names. Loops that
        cannot be read are there too, with the reason.
    """
    loops = source.loops()
    done: dict[str, PlantLoop] = {}
    begun: Begun = {}
    cascades = Cascades()
    for start in range(0, len(loops), BATCH):
        for loop, record in source.read(loops[start : start + BATCH]):
            done[loop.tag] = _looked_at(loop, record, begun)
            if isinstance(record, LoopRecord):
                cascades.add(loop.tag, record)
            if progress is not None:
                progress(len(done), len(loops))
    _tie(done, cascades.slaves())
    return (*(done[loop.tag] for loop in loops if loop.tag in done), *_guessed(source, {loop.tag for loop in loops}))


def _tie(loops: dict[str, PlantLoop], slaves: Mapping[str, str]) -> None:
    """Name the slave of each master, and say so to both."""
    for master, slave in slaves.items():
        said = f"OP is the set point of {slave}: a master, without a valve of its own."
        loops[master] = replace(loops[master], slave=slave, notes=(*loops[master].notes, said))
        loops[slave] = replace(loops[slave], notes=(*loops[slave].notes, f"SP is OP of {master}."))


def _looked_at(loop: PlantLoop, record: LoopRecord | LostMotionError, begun: Begun) -> PlantLoop:
    if isinstance(record, LostMotionError):
        return replace(loop, notes=(*loop.notes, f"CANNOT BE READ: {in_loop_list(' '.join(str(record).split()))}."))
    notes = [*loop.notes, *_read_so(record)]
    span, said = op_limits(record)
    notes += said
    kind = loop.loop_type or record.loop_type
    if not kind and (kind := type_of_unit(record.pv_unit)):
        notes.append(f"Type {kind!r} by the unit of PV.")
    same = _same(loop.tag, record, begun)
    if same:
        notes.append(f"Begins with the values of {same}: perhaps the same record.")
    if record.start is None:
        notes.append("Not dated.")
    if record.pv_span is None:
        notes.append(NO_PV_SPAN)
    return replace(
        loop,
        loop_type=kind,
        op_span=span,
        pv_span=record.pv_span,
        op_unit=record.op_unit,
        pv_unit=record.pv_unit,
        notes=tuple(notes),
    )


def _same(tag: str, record: LoopRecord, begun: Begun) -> str:
    """Tag of a record that was seen before and begins with the same values, written with whatever digits."""
    first = np.stack([record.op[:COMPARED], record.pv[:COMPARED]])
    with np.errstate(invalid="ignore", divide="ignore"):
        even = (first - first.mean(axis=1, keepdims=True)) / first.std(axis=1, keepdims=True)
    if not np.isfinite(even).all():  # missing values, or by hand: nothing to be told by
        return ""
    others = begun.setdefault(np.round(even[:, :KEYED], 1).tobytes(), [])
    scale = NEAR * first.std(axis=1, keepdims=True)
    for other, values in others:
        if values.shape == first.shape and (np.abs(values - first) <= scale + NEAR * np.abs(first)).all():
            return other
    others.append((tag, first))
    return ""


def _read_so(record: LoopRecord) -> list[str]:
    return [
        in_loop_list(note)
        for note in record.notes
        if note.startswith("OP is in") or "left out" in note.lower() or "was read from column" in note
    ]


def op_limits(record: LoopRecord) -> tuple[tuple[float, float] | None, list[str]]:
    """Limits of OP where the data look like per cent or a share of 1, and a remark.

    Examples
    --------
    >>> op_limits(LoopRecord([20.0, 45.0], [1.0, 2.0], dt=1.0))
    ((0.0, 100.0), ['OP limits 0 .. 100 by the data, 20 .. 45.'])
    >>> op_limits(LoopRecord([-20.0, 45.0], [1.0, 2.0], dt=1.0))[0] is None
    True
    """
    if record.op_span is not None:
        return record.op_span, []
    values = record.op[np.isfinite(record.op)]
    if not len(values):
        return None, ["OP has no values."]
    low, high = float(values.min()), float(values.max())
    possible = possible_spans(record.op_unit, values)
    shown = [f"{ends[0]:g} .. {ends[1]:g}" for ends in possible]
    if len(shown) == 1:
        doubt = "; or 0 .. 100 and nearly closed: check" if possible[0] == FRACTION else ""
        return possible[0], [f"OP limits {shown[0]} by the data, {low:.4g} .. {high:.4g}{doubt}."]
    may = f"; they may be {' or '.join(shown)}: fill in the right ones" if shown else ""
    return None, [f"OP limits not known: the data go from {low:.4g} to {high:.4g}{may}."]


def type_of_unit(unit: str) -> str:
    """What PV measures by its unit; empty: not to be told.

    Examples
    --------
    >>> type_of_unit("m3/h"), type_of_unit("degC"), type_of_unit("%")
    ('flow', 'temperature', '')
    """
    return next((kind for kind, units in UNIT_TYPES.items() if unit.strip().lower() in units), "")


def _guessed(source: PlantSource, tags: Sequence[str] | set[str]) -> Iterator[PlantLoop]:
    """A line for each file with columns of numbers of which two may be OP and PV."""
    if not isinstance(source, FilesSource):
        return
    for unit in source.survey.units:
        ways = likely(unit.names, {}) if unit.failed and unit.names else []
        if not ways:
            continue
        path = unit.files[0]
        tag = path_stem(path)
        tag = tag if tag not in tags else below(path, source.root)
        kind = loop_type(tag)
        note = "OP and PV are a guess by the names of the columns: CHECK THEM."
        yield PlantLoop(
            tag, str(ways[0]["op"]), str(ways[0]["pv"]), loop_type=kind, area=_folder(path, source.root),
            where=written([Place(tuple(below(file, source.root) for file in unit.files))]), notes=(note,),
        )  # fmt: skip


def _folder(path: Path, root: Path) -> str:
    folder = path.parent
    return folder.relative_to(root).as_posix() if folder != root and folder.is_relative_to(root) else ""
