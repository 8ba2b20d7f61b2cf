"""Block from the saved dictionary of a fit: what ``lostmotion identify --out`` wrote."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lostmotion.arguments import positive
from lostmotion.compensate.block import CompensatorBlock
from lostmotion.compensate.derive import SIZE, _process_time, block_from_model
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.models import LinearModel
from lostmotion.models.series import actuator_from_dict


def block_from_saved(
    fit: Mapping[str, Any],
    *,
    span: tuple[float, float],
    scan_time: float | None = None,
    factor: float | None = None,
    **options: Any,
) -> CompensatorBlock:
    """Block from ``HammersteinFit.to_dict()``, by the rules of :func:`block_from_fit`.

    Parameters
    ----------
    fit : mapping
        Dictionary of a fit, or of a block (``CompensatorBlock.to_dict()``), whose settings then stand.
    span : (float, float)
        Smallest and largest OP: the clamps.
    scan_time, factor, **options
        As in :func:`block_from_fit`. The noise of OP is not in the file: give `op_noise`, else a tenth of the width
        is taken and the notes say so.

    Raises
    ------
    ParameterError
        A fit whose status does not carry a compensation, a width that may be nothing, a span that OP leaves.
    DataError
        A dictionary that is neither.
    """
    if {"kind", "scan_time", "settings"} <= fit.keys():
        changes = {"factor": factor, **options}
        return _again(fit, scan_time, {name: value for name, value in changes.items() if value is not None})
    if not {"status", "preferred", "model", "intervals_95", "data"} <= fit.keys():
        raise DataError.expected("the dictionary of a fit or of a block", sorted(fit), "use identify --out")
    valve, linear = actuator_from_dict(fit["model"]["nonlinearity"]), LinearModel.from_dict(fit["model"]["linear"])
    kind = valve.kind
    if fit["preferred"] != kind or kind not in SIZE:
        got = f"{fit['preferred']} (status {fit['status']})"
        raise ParameterError.expected("a fit that shows a lost motion with a block", got, Status[fit["status"]].value)
    notes = [f"from a fit of {fit['data']['samples']} samples, status {fit['status']}"]
    if factor is None:
        name = SIZE[kind]
        lowest, size = fit["intervals_95"][name][0], fit["parameters"][name]
        if lowest is None or not lowest > 0.0:
            remedy = "record more moves of OP, or give a factor"
            raise ParameterError.expected(f"a {name} that is surely above 0", f"{size:.3g} from {lowest}", remedy)
        factor = min(lowest / size, 1.0)
        notes.append(f"factor {factor:.3f}: lower end of the 95% interval of the {name} {size:.4g}")
    if options.get("method") == "two moves" and fit["settings"]["chosen"]["integrating"]:
        raise ParameterError.expected("a self-regulating process", "an integrating one", "take method='knocker'")
    least, most = fit["data"].get("op_range", span)
    if least < span[0] or most > span[1]:
        got = f"{span}, OP {least:.4g} to {most:.4g}"
        raise ParameterError.expected("a span that holds the OP of the record", got, "give the true limits of OP")
    scan = fit["data"]["dt"] if scan_time is None else positive("scan_time", scan_time)
    found = {"factor": factor, "process_time": _process_time(linear), **options}
    return block_from_model(valve, scan, span=span, notes=tuple(notes), **found)


def _again(saved: Mapping[str, Any], scan_time: float | None, changes: dict[str, float]) -> CompensatorBlock:
    """The saved block itself; ramp_step, rate and counts are in scans, so its scan time stands."""
    block = CompensatorBlock.from_dict(saved)
    if scan_time is not None and scan_time != block.scan_time:
        remedy = "make the block again for this scan time"
        raise ParameterError.expected(f"the scan time of the block, {block.scan_time:g} s", scan_time, remedy)
    if "ramp" in changes:  # in units of OP a second, as wherever a block is made
        changes = {**changes, "ramp_step": positive("ramp", changes["ramp"]) * block.scan_time}
        del changes["ramp"]
    return block.with_settings(**changes) if changes else block
