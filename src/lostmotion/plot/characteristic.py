"""The panel of the valve: what arrives behind it, over OP."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.plot.style import BAND, MEASURED, MODEL, calm, labelled, rounded

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARGIN = 0.04  # of the range of OP that the panel shows beside it
TYPICAL_TURN = 0.05  # quantile of OP about which most of its moves turn
LOOP_POINTS = 500
LEAST_TRAVEL = 0.2  # of the size, that the valve has in a loop that shows anything
WIDENING, MAX_WIDENINGS = 1.2, 12  # of OP, until it has
MOST_PATH = 2000  # rows: more of them would fill the loop
VISITS_HEIGHT = 0.15  # of the panel


def draw_characteristic(axes: Axes, fit: HammersteinFit) -> None:
    """Draw the characteristic of a fit, with the intervals of its breakpoints, and where OP was.

    A valve with memory has a loop: stuck after each reversal of OP, then a slip if it sticks, then it moves along one
    of two lines. Thin lines are the path that the model takes over the record. Where the fit gives no number for a
    fault, the valve is drawn as a straight line.
    """
    kind, valve, u = fit.kind, fit.nonlinearity, fit.data.u
    low, high = float(u.min()), float(u.max())
    margin = MARGIN * (high - low)
    ends = (low - margin, high + margin)
    grid = np.linspace(*ends, 600)
    if kind.name == NO_FAULT or fit.status in HIDDEN:
        axes.plot(grid, grid if kind.name != NO_FAULT else np.asarray(valve(grid)), color=MODEL, lw=1.8)
        title = "Valve: no lost motion in the model" if fit.preferred == NO_FAULT else "Valve: no fault can be shown"
    elif kind.sticks:
        _loop(axes, fit)
        title = _title(fit)
    else:
        _breakpoints(axes, fit, ends)
        axes.plot(grid, np.asarray(valve(grid)), color=MODEL, lw=1.8)
        title = _title(fit)
    _visits(axes, u)
    in_op = not kind.has_slopes or fit.settings["gain"] is None  # with a known gain the slopes are no longer 1
    unit = fit.data.op_unit
    calm(axes, title, labelled("OP", unit), labelled("OP behind the valve (effective)", unit if in_op else ""))


def _title(fit: HammersteinFit) -> str:
    kind = fit.kind.name
    if fit.preferred != kind:
        return f"Not reliable: {kind}, {size_words(fit)}"
    return f"{kind.capitalize()}: {size_words(fit)}"


def size_words(fit: HammersteinFit) -> str:
    """Return the size of the fault with its interval and unit; of a kind without a size its breakpoints."""
    name, unit, span = fit.kind.size, fit.data.op_unit, fit.data.op_span
    unit = f" {unit}" if unit else ""
    if name is None:
        return "at " + " and ".join(_value(fit, one) for one in fit.kind.model.own) + unit
    low, high = fit.size_interval  # the one that every report shows
    spread = high - low
    between = f"{rounded(low, spread)} .. {rounded(high, spread)}" if np.isfinite(spread) else "not bounded"
    if fit.status is Status.WIDE:
        return f"{name} not determined (95 %: {between}{unit})"
    text = f"{name} {rounded(fit.parameters[name], spread)}{unit} (95 %: {between})"
    if span is not None and unit.strip() != "%":
        text += f", {100.0 * fit.parameters[name] / (span[1] - span[0]):.3g} % of span"
    if fit.kind.nests:
        extra = fit.kind.model.own[-1]
        text += f", {fit.kind.words.extra} {_value(fit, extra)}{unit}"
    return text


def _value(fit: HammersteinFit, name: str) -> str:
    low, high = fit.interval(name)
    return rounded(fit.parameters[name], high - low)


def _breakpoints(axes: Axes, fit: HammersteinFit, ends: tuple[float, float]) -> None:
    """Breakpoints of a static characteristic with their intervals; those beyond the record are left out."""
    shown = [name for name in fit.kind.break_points if ends[0] <= fit.parameters[name] <= ends[1]]
    values = " and ".join(_value(fit, name) for name in shown)
    for name in shown:
        low, high = fit.interval(name)
        first = name == shown[0]
        said = "95 % interval" if first else None
        axes.axvspan(max(low, ends[0]), min(high, ends[1]), color=BAND, alpha=0.6, lw=0, label=said)
        plural = "s" if len(shown) > 1 else ""
        said = f"breakpoint{plural} {values}" if first else None
        axes.axvline(fit.parameters[name], color=MODEL, lw=0.9, ls=":", label=said)


def _loop(axes: Axes, fit: HammersteinFit) -> None:
    """Loop that the model of the valve goes through while OP goes slowly to and fro, over its path in the record."""
    valve, u = fit.nonlinearity, fit.data.u
    op, x = _slow_loop(fit)
    for way, style, said in ((0, "-", "OP rising"), (1, "--", "OP falling")):
        axes.plot(op[way], x[way], color=MODEL, lw=1.8, ls=style, label=said)
    path_name = "path in the record" if u.size <= MOST_PATH else f"path, last {MOST_PATH} rows"
    for start, stop in fit.data.segments.tolist():
        if stop > u.size - MOST_PATH:
            path = np.asarray(valve(u[start:stop]))
            rows = slice(max(start, u.size - MOST_PATH) - start, stop - start)
            axes.plot(u[start:stop][rows], path[rows], color=MEASURED, lw=0.5, alpha=0.5, zorder=1.5, label=path_name)
            path_name = ""  # one entry of the legend for all pieces


def _slow_loop(fit: HammersteinFit) -> tuple[FloatArray, FloatArray]:
    """OP and position, shape (2, LOOP_POINTS) each: on the way up and down, as far as OP turns in the record.

    Where the valve would hardly move there, OP goes farther.
    """
    low, high = (float(np.quantile(fit.data.u, share)) for share in (TYPICAL_TURN, 1.0 - TYPICAL_TURN))
    size = float(getattr(fit.nonlinearity, fit.kind.model.own[0]))
    middle, half = 0.5 * (low + high), max(0.5 * (high - low), 0.5 * size)
    for _ in range(MAX_WIDENINGS):
        up = np.linspace(middle - half, middle + half, LOOP_POINTS)
        op = np.stack([up, up[::-1]])
        x = np.asarray(fit.nonlinearity(np.tile(op.ravel(), 3)))[-op.size :]  # two cycles lead into the loop
        if np.ptp(x) >= LEAST_TRAVEL * size:
            break
        half *= WIDENING
    return op, x.reshape(op.shape)


def _visits(axes: Axes, u: FloatArray) -> None:
    """Histogram of OP along the lower edge."""
    counts, edges = np.histogram(u, bins=80)
    base, top = (float(end) for end in axes.get_ylim())
    base -= VISITS_HEIGHT * (top - base)
    height = VISITS_HEIGHT * (top - base) * counts / counts.max()
    axes.bar(edges[:-1], height, np.diff(edges), bottom=base, align="edge", color="0.85", lw=0, label="where OP was")
    axes.set_ylim(base, top)
