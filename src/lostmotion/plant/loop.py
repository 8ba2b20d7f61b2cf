"""PlantLoop: one control loop of a plant, as a loop list has it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class PlantLoop:
    """One control loop, and where its data lie. A row of a loop list.

    Attributes
    ----------
    tag : str
        Name of the loop; no two of a plant have the same.
    op, pv, sp, mode : str
        Names of its columns or tags in the data; empty: as the reader finds them, or none.
    loop_type : str
        What PV measures ("flow", "level" ..), as :func:`lostmotion.diagnose` takes it; empty: not known.
    op_span, pv_span : (float, float), optional
        Engineering limits. None: as the data say, or unknown.
    op_unit, pv_unit : str
        Engineering units; empty: not known.
    area : str
        Part of the plant; empty: not known.
    weight : float
        What the loop is worth against the others; 1 is usual.
    where : str
        The source's own address of its data: a file, a loop of a file, a tag of a table.
    size : int
        Bytes to be read for it, about: batches are made by it. 0: not known.
    stamp : str
        Changes whenever the data may have changed (size and time of a file); empty: not known without reading.
    notes : tuple of str
        What was inferred for want of a loop list, one sentence each.
    dt : float, optional
        Sampling time in seconds, where the data do not tell it or tell it wrong.
    time : str
        Column of times; "none": it is not to be believed, and `dt` counts alone. Empty: as the reader finds it.
    slave : str
        Of a master: tag of the loop whose set point its OP is. It has no valve of its own. Empty: none.
    """

    tag: str
    op: str = ""
    pv: str = ""
    sp: str = ""
    mode: str = ""
    loop_type: str = ""
    op_span: tuple[float, float] | None = None
    pv_span: tuple[float, float] | None = None
    op_unit: str = ""
    pv_unit: str = ""
    area: str = ""
    weight: float = 1.0
    where: str = ""
    size: int = 0
    stamp: str = ""
    notes: tuple[str, ...] = ()
    dt: float | None = None
    time: str = ""
    slave: str = ""
