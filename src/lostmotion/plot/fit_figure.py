"""The figure of an identification: characteristic, step response, simulation, residual correlations."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.identify.likelihood.misfit import autocorrelation
from lostmotion.models import Nonlinearity
from lostmotion.plot.style import ALERT, BAND, MEASURED, MODEL, MOST_POINTS, calm, labelled, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LAGS = 30
BAND_99 = 2.576


def fit_figure(fit: HammersteinFit, title: str | None = None) -> Figure:
    """Four panels: characteristic with intervals, step response, measured and simulated PV, residuals.

    Parameters
    ----------
    fit : HammersteinFit
    title : str, optional
        Heading; default the tag and the status.
    """
    figure = new_figure()
    grid = figure.add_gridspec(2, 4)
    name = fit.data.tag or fit.data.source or "record"
    figure.suptitle(title or f"{name}: {fit.status.name.replace('_', ' ').lower()}", fontsize=12, x=0.01, ha="left")
    _characteristic(figure.add_subplot(grid[0, :2]), fit)
    _step(figure.add_subplot(grid[0, 2:]), fit)
    _simulation(figure.add_subplot(grid[1, :2]), fit)
    _autocorrelation(figure.add_subplot(grid[1, 2]), fit)
    _cross_correlation(figure.add_subplot(grid[1, 3]), fit)
    return figure


def _characteristic(axes: Axes, fit: HammersteinFit) -> None:
    unseen = fit.status in (Status.NOT_SEEN, Status.CANNOT_TELL, Status.SAME_SIGNAL)
    u = fit.data.u
    low, high = float(u.min()), float(u.max())
    margin = 0.04 * (high - low)
    grid = np.linspace(low - margin, high + margin, 600)
    valve, kind = fit.nonlinearity, fit.kind
    title = f"Characteristic: no {kind.name} seen" if kind.name != NO_FAULT else "Characteristic: no fault"
    if kind.sticks and not unseen:
        title = _path(axes, fit, valve, grid)
    elif kind.sticks:
        axes.plot(grid, grid, color=MODEL, lw=1.8)
    else:
        if kind.name != NO_FAULT and not unseen:
            title = f"{kind.name.capitalize()}, 95 % intervals"
            _mark(axes, fit, kind.break_points, (low - margin, high + margin))
        axes.plot(grid, np.asarray(valve(grid)), color=MODEL, lw=1.8)
    _visited(axes, u)
    unit = fit.data.op_unit
    calm(axes, title, f"{labelled('OP', unit)} (grey: where it was)", labelled("x", unit))


def _mark(axes: Axes, fit: HammersteinFit, names: tuple[str, ...], ends: tuple[float, float]) -> None:
    """Kinks of a static characteristic with their intervals; those beyond the record are left out."""
    for index, name in enumerate(names):
        value = fit.parameters[name]
        if not ends[0] <= value <= ends[1]:
            continue
        low, high = fit.interval(name)
        axes.axvspan(max(low, ends[0]), min(high, ends[1]), color=BAND, alpha=0.6, lw=0)
        axes.axvline(value, color=MODEL, lw=0.8, ls=":")
        axes.annotate(
            f"{name} {value:.4g}", (value, 1.0), xycoords=("data", "axes fraction"),
            fontsize=8, ha="left" if index else "right", va="top", color=MODEL,
        )  # fmt: skip


def _path(axes: Axes, fit: HammersteinFit, valve: Nonlinearity, grid: FloatArray) -> str:
    """Path of a valve with memory over the record, between the lines on which it moves; return the title.

    What its parameter beside the size is (the slip jump), it moves nearer to OP, and breaks away later.
    """
    name, *others = fit.kind.model.own
    size, jump = getattr(valve, name), sum(getattr(valve, other) for other in others)
    glide = 0.5 * (size - jump)
    for start, stop in fit.data.segments:
        u = fit.data.u[start:stop]
        axes.plot(u, np.asarray(valve(u)), color=MEASURED, lw=0.4, alpha=0.7)
    for sign, label in ((-1.0, "moves, OP rising"), (1.0, "moves, OP falling")):
        axes.plot(grid, grid + sign * glide, color=MODEL, lw=1.3, ls="-" if sign < 0 else "--", label=label)
    if others:
        edge = 0.5 * (size + jump)
        axes.fill_between(grid, grid - edge, grid + edge, color=BAND, alpha=0.3, lw=0, label="stuck within")
    axes.legend(fontsize=8, framealpha=0.85, edgecolor="none", loc="lower right")
    low, high = fit.interval(name)
    text = f"{valve.kind.capitalize()}: {name} {size:.3g}, 95 % {low:.3g} .. {high:.3g}"
    return text + "".join(f", {other} {getattr(valve, other):.3g}" for other in others)


def _visited(axes: Axes, u: FloatArray) -> None:
    """Histogram of OP along the lower edge."""
    counts, edges = np.histogram(u, bins=80)
    base, top = (float(end) for end in axes.get_ylim())
    height = 0.18 * (top - base) * counts / counts.max()
    axes.bar(edges[:-1], height, np.diff(edges), bottom=base, align="edge", color="0.85", lw=0)
    axes.set_ylim(bottom=base)


def _step(axes: Axes, fit: HammersteinFit) -> None:
    slowest = max((abs(pole) for pole in fit.linear.poles), default=0.0)
    slowest = min(slowest, 0.9995)
    samples = fit.linear.delay + max(20, int(5 / max(-np.log(max(slowest, 1e-9)), 1e-3)))
    samples = min(samples, fit.data.u.size)
    time = np.arange(samples) * fit.data.dt
    axes.step(time, fit.linear.step_response(samples), where="post", color=MODEL, lw=1.5)
    axes.axhline(fit.linear.gain, color="0.6", lw=0.8, ls="--")
    calm(
        axes,
        f"Step response of the linear part, gain {fit.linear.gain:.4g}",
        "time, s",
        f"{labelled('PV', fit.data.pv_unit)} per unit of x",
    )


def _simulation(axes: Axes, fit: HammersteinFit) -> None:
    y = fit.data.y
    shown = max(0, y.size - MOST_POINTS)
    rows = slice(shown, y.size)
    time = np.arange(y.size)[rows] * fit.data.dt
    axes.plot(time, y[rows], color=MEASURED, lw=0.8, label="measured")
    axes.plot(time, fit.simulated[rows], color=MODEL, lw=1.0, label="simulated from OP")
    axes.legend(fontsize=8, frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.0)
    which = "" if shown == 0 else f", last {MOST_POINTS} samples"
    calm(axes, f"Simulated fit {fit.fit_percent:.1f} %{which}", "time, s", labelled("PV", fit.data.pv_unit))


def _autocorrelation(axes: Axes, fit: HammersteinFit) -> None:
    errors = fit.residuals
    lags = min(LAGS, errors.size // 4)
    _stems(axes, np.arange(1, lags + 1), autocorrelation([errors], lags)[1:], errors.size)
    calm(axes, "Residual autocorrelation", "lag, samples", "")


def _cross_correlation(axes: Axes, fit: HammersteinFit) -> None:
    errors = fit.residuals
    u = np.diff(fit.data.u, prepend=fit.data.u[0])[-errors.size :]  # moves of OP: nearer to white than OP
    u = u - u.mean()
    lags = np.arange(-LAGS // 3, LAGS + 1)
    size = np.sqrt(float(u @ u) * float(errors @ errors)) + 1e-300
    values = [
        float(errors[max(lag, 0) : errors.size + min(lag, 0)] @ u[max(-lag, 0) : u.size - max(lag, 0)]) / size
        for lag in lags.tolist()
    ]
    delay = fit.linear.delay
    _stems(axes, lags, np.array(values), errors.size, lags >= delay)
    axes.axvspan(lags[0] - 0.5, delay - 0.5, color="0.9", lw=0, zorder=3, alpha=0.9)
    axes.text(0.02, 0.02, "before the delay:\nfeedback", transform=axes.transAxes, fontsize=7, color="0.35", zorder=4)
    calm(axes, "OP moves to residual", "lag, samples", "")


def _stems(axes: Axes, lags: np.ndarray, values: np.ndarray, n: int, judged: np.ndarray | None = None) -> None:
    """Correlations with their 99 % band; the axis fits the `judged` ones (default all)."""
    limit = BAND_99 / np.sqrt(n)
    outside = np.abs(values) > limit
    axes.axhspan(-limit, limit, color=BAND, alpha=0.6, lw=0)
    axes.vlines(lags, 0, values, color=np.where(outside, ALERT, MODEL), lw=1.5)
    axes.axhline(0, color="0.4", lw=0.6)
    shown = values if judged is None else values[judged]
    reach = max(1.3 * limit, 1.15 * float(np.abs(shown).max()))
    axes.set_ylim(-reach, reach)
