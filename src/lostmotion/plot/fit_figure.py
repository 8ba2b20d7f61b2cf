"""The figure of an identification: trend and valve for the plant, process and residuals for who checks the model."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NO_FAULT
from lostmotion.identify.earned import fit_without_drift
from lostmotion.identify.likelihood.misfit import autocorrelation
from lostmotion.identify.rated_estimate import HIDDEN
from lostmotion.plot.characteristic import draw_characteristic, size_words
from lostmotion.plot.step_response import draw_step_response
from lostmotion.plot.style import ALERT, BAND, MODEL, calm, heading, new_figure, one_panel
from lostmotion.plot.trend import draw_trend
from lostmotion.records import LoopRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

LAGS = 30
BAND_99 = 2.576


def fit_figure(
    fit: HammersteinFit,
    title: str | None = None,
    figure: Figure | SubFigure | None = None,
    ax: Axes | None = None,
) -> Figure:
    """Valve, process, PV measured and simulated with SP, OP, correlations of the residuals.

    Parameters
    ----------
    fit : HammersteinFit
    title : str, optional
        Heading; default the tag and what was found.
    figure : matplotlib Figure or SubFigure, optional
        Drawn into instead of a new one.
    ax : matplotlib Axes, optional
        Takes the characteristic of the valve alone.

    Raises
    ------
    ParameterError
        Both `figure` and `ax`, or one that is of no such type.
    """
    if ax is not None:
        return one_panel(ax, figure, lambda axes: draw_characteristic(axes, fit))
    figure = new_figure(12.5, 9.0, figure)
    heading(figure, title or fit_heading(fit))
    grid = figure.add_gridspec(2, 1, height_ratios=(2.4, 1.0))
    upper, lower = grid[0].subgridspec(1, 2, width_ratios=(2.0, 1.0)), grid[1].subgridspec(1, 3)
    draw_characteristic(
        figure.add_subplot(upper[1].subgridspec(1, 1)[0]), fit
    )  # nested: with its own room for texts above
    draw_step_response(figure.add_subplot(lower[0]), fit)
    rows = upper[0].subgridspec(2, 1, height_ratios=(1.2, 1.0))
    above = figure.add_subplot(rows[0])
    below = figure.add_subplot(rows[1], sharex=above)
    shown = fit.simulated if fit.fit_percent > 0.0 else None
    draw_trend(above, below, _record_of(fit), simulated=shown, title=_trend_title(fit))
    _autocorrelation(figure.add_subplot(lower[1]), fit)
    _cross_correlation(figure.add_subplot(lower[2]), fit)
    return figure


def fit_heading(fit: HammersteinFit) -> str:
    """Return tag, finding with its size, and status, in a line."""
    name = fit.data.tag or fit.data.source or "record"
    return f"{name}: {_finding(fit)}; status {fit.status.name}"


def _finding(fit: HammersteinFit) -> str:
    kind, preferred = fit.kind, fit.preferred
    if preferred == NO_FAULT:
        unit = f" {fit.data.op_unit}" if fit.data.op_unit else ""
        bound = fit.widest
        seen = f", none above {bound:.2g}{unit} (95 %)" if bound is not None and np.isfinite(bound) else ""
        return f"no lost motion seen{seen}"
    if preferred == "cannot tell":
        if kind.name == NO_FAULT or fit.status in HIDDEN:
            return "cannot tell (a fault is neither shown nor excluded)"
        return f"cannot tell ({kind.name} fits best, but not reliably)"
    if preferred != kind.name:
        return f"{preferred} fits better than the {kind.name} asked for"
    return f"{kind.name}, {size_words(fit)}"


def _record_of(fit: HammersteinFit) -> LoopRecord:
    """Rows of the fit as a record, with the dates and the lengths of gaps that are known."""
    data = fit.data
    begins, ends = data.segments.T
    gaps, start, seconds = tuple(begins[1:].tolist()), None, ()
    known = [moment for moment in data.starts if moment is not None]
    if known and len(known) == len(begins):
        since = np.array([(moment - known[0]).total_seconds() for moment in known])
        lost = np.diff(since) - data.dt * (ends - begins)[:-1]
        if (lost > -data.dt).all():  # pieces in the order in which they were recorded
            start, seconds = known[0], tuple(np.maximum(lost, 0.0).tolist())
    return LoopRecord(
        data.u, data.y, data.sp, dt=data.dt, gaps=gaps, gap_seconds=seconds, start=start,
        op_unit=data.op_unit, pv_unit=data.pv_unit,
    )  # fmt: skip


def _trend_title(fit: HammersteinFit) -> str:
    """How well the model follows PV; a per cent below zero says nothing to anybody."""
    if fit.fit_percent > 0.0:
        return f"Measurement, and the model from OP alone: fit {fit.fit_percent:.0f} %"
    if fit_without_drift(fit.data.y, fit.simulated, fit.data.segments) > 0.0:
        return "Measurement (the model from OP alone, which drifts away from PV, is not drawn)"
    return "Measurement (the model does not reproduce it from OP alone)"


def _autocorrelation(axes: Axes, fit: HammersteinFit) -> None:
    errors = fit.residuals
    lags = min(LAGS, errors.size // 4)
    _stems(axes, np.arange(1, lags + 1), autocorrelation([errors], lags)[1:], errors.size)
    calm(axes, "Residuals: autocorrelation", "lag, samples", "correlation")


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
    axes.axvspan(lags[0] - 0.5, delay - 0.5, color="0.9", lw=0, zorder=3, alpha=0.9, label="before the delay: feedback")
    calm(axes, "Residuals after moves of OP", "lag, samples", "correlation")


def _stems(axes: Axes, lags: np.ndarray, values: np.ndarray, n: int, judged: np.ndarray | None = None) -> None:
    """Correlations with their 99 % band; the axis fits the `judged` ones (default all)."""
    limit = BAND_99 / np.sqrt(n)
    outside = np.abs(values) > limit
    axes.axhspan(-limit, limit, color=BAND, alpha=0.6, lw=0, label="99 % of white noise")
    axes.vlines(lags, 0, values, color=np.where(outside, ALERT, MODEL), lw=1.5)
    axes.axhline(0, color="0.4", lw=0.6)
    shown = values if judged is None else values[judged]
    reach = max(1.3 * limit, 1.15 * float(np.abs(shown).max()))
    axes.set_ylim(-reach, reach)
