"""Both studies as one HTML page with its figures inside, and as JSON."""

from __future__ import annotations

import base64
import html
import io
from typing import TYPE_CHECKING, Any

import numpy as np

from lostmotion.paper import figures
from lostmotion.paper.control import CASES, ControlStudy
from lostmotion.paper.estimation import NAMES, EstimationStudy
from lostmotion.paper.published import CONVERGED_BY, ERRATA, SYMBOLS, TABLE_1, TABLE_2
from lostmotion.simulate.platforms.level_tank import DT

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TITLES = {
    "riv": "RIV (the paper)",
    "rls": "least squares",
    "els": "extended LS",
    "voros": "Voros 1997",
    "ml": "identify (ML)",
}


def to_dict(estimation: EstimationStudy, control: ControlStudy) -> dict[str, Any]:
    """Every number of the page, ready for JSON; what is not finite becomes None."""
    table_2 = {
        f"{case} {track}": {
            "published": list(TABLE_2[track][case]) if case != "ideal" else None,
            "mean": list(control.mean(case, track)),
            "spread": list(control.spread(case, track)),
        }
        for case in CASES
        for track in TABLE_2
    }
    methods = {method: estimation.summary(method) for method in estimation.runs}
    plain = {
        "samples": estimation.samples,
        "table_1": {"published": {name: list(pair) for name, pair in TABLE_1.items()}, "methods": methods},
        "table_2": table_2,
        "iae": {case: control.iae(case) for case in CASES},
        "limit_cycle": {f"{case} {track}": value for (case, track), value in control.limit_cycle.items()},
        "errata": [list(item) for item in ERRATA],
    }
    cleaned: dict[str, Any] = _finite(plain)
    return cleaned


def write_page(estimation: EstimationStudy, control: ControlStudy) -> str:
    """The page as text; figures are embedded."""
    parts = [
        "<h1>Estimation and compensation of dead-zone, ICINCO 2010, again</h1>",
        f"<p>Cequeira, Vale, Fonseca, Araujo, Maitelli. Every table and figure from a run of this program: "
        f"{_seeds(estimation)} seeds of {estimation.samples:,} samples ({estimation.samples * DT:,.0f} s) for the "
        f"estimation, {len(control.indices['with', 1])} noise sequences for the control.</p>",
        "<h2>Table 1: parameters</h2>",
        _table_1(estimation),
        _method_text(estimation),
        "<h2>Table 2: indices</h2>",
        _table_2(control),
        _control_text(control),
        "<h2>Figures</h2>",
        _picture(figures.characteristics(), "dead zone and inverse"),
    ]
    if "riv" in estimation.runs:
        parts.append(_picture(figures.trajectories(estimation), "estimates along the run"))
    parts += [_picture(figures.responses(control), "responses of the loop"), "<h2>Errata and open points</h2>"]
    parts += [f"<p><b>{html.escape(where)}.</b> {html.escape(text)}</p>" for where, text in ERRATA]
    return PAGE.format(body="\n".join(parts))


def _seeds(estimation: EstimationStudy) -> int:
    return max(len(runs) for runs in estimation.runs.values())


def _table_1(estimation: EstimationStudy) -> str:
    methods = list(estimation.runs)
    head = ["", "real", "published"] + [f"{TITLES[method]}<br>mean +- RMSE" for method in methods]
    rows = []
    for name in NAMES:
        published, real = TABLE_1[name]
        cells = [SYMBOLS.get(name, name), f"{real:g}", f"{published:g}"]
        for method in methods:
            mean, _, rmse = estimation.spread(method, name)
            cells.append(f"{mean:.5f} +- {rmse:.5f}" if np.isfinite(mean) else "-")
        rows.append(cells)
    summary = {method: estimation.summary(method) for method in methods}
    rows.append(["converged", "", "yes"] + [f"{summary[m]['converged']} of {summary[m]['seeds']}" for m in methods])
    times = [summary[method]["convergence_time_s"] for method in methods]
    shown = ["batch" if value is None else f"{value:,.0f} s" if np.isfinite(value) else "never" for value in times]
    rows.append(["within 10 % after", "", f"{CONVERGED_BY:,.0f} s", *shown])
    return _table(head, rows)


def _method_text(estimation: EstimationStudy) -> str:
    text = []
    if "rls" in estimation.runs:
        mean = estimation.spread("rls", "right_slope")[0]
        error = estimation.summary("rls")["standard_error"]["right_slope"]
        text.append(
            f"Least squares is biased by the output noise: mr = {mean:.3f}, {abs(mean - 3) / error:.0f} of its own "
            f"standard errors from 3."
        )
    if {"riv", "ml"} <= estimation.runs.keys():
        ratios = [estimation.spread("riv", name)[2] / estimation.spread("ml", name)[2] for name in ("left", "right")]
        text.append(
            f"Maximum likelihood on the same data has break-point errors {min(ratios):.0f} to {max(ratios):.0f} times "
            "smaller than RIV."
        )
    return f"<p>{html.escape(' '.join(text))}</p>"


def _table_2(control: ControlStudy) -> str:
    head = ["track", "case", "eps1 published", "eps1 mean (spread)", "eps2 published", "eps2 mean (spread)", "ratio"]
    rows = []
    for track in TABLE_2:
        for case in ("without", "with", "ideal"):
            mean, spread = control.mean(case, track), control.spread(case, track)
            published = TABLE_2[track].get(case)
            cells = [str(track), {"ideal": "no dead zone"}.get(case, f"{case} compensation")]
            for index in (0, 1):
                cells.append("" if published is None else f"{published[index]:.4f}")
                cells.append(f"{mean[index]:.4f} ({spread[index]:.4f})")
            cells.append("" if published is None else f"{mean[1] / published[1]:.3f}")
            rows.append(cells)
    return _table(head, rows)


def _control_text(control: ControlStudy) -> str:
    worst = max(
        (abs(control.mean(case, track)[1] / TABLE_2[track][case][1] - 1), track, case)
        for track in TABLE_2
        for case in ("without", "with")
    )
    _, track, case = worst
    away = (TABLE_2[track][case][1] - control.mean(case, track)[1]) / control.spread(case, track)[1]
    quiet = max(control.limit_cycle["with", 2], control.limit_cycle["with", 3])
    text = (
        f"The spread is from seed to seed; the paper has one noise sequence. The farthest eps2, track "
        f"{track} {case} compensation, is {100 * worst[0]:.1f} % off its mean, {abs(away):.1f} spreads of one run. "
        f"Compensated with table 1's estimates the IAE over all tracks is {control.iae('with'):.4f}, without dead zone "
        f"{control.iae('ideal'):.4f}, uncompensated {control.iae('without'):.4f}. Without noise the level swings by "
        f"{control.limit_cycle['without', 2]:.2f} and {control.limit_cycle['without', 3]:.2f} % in tracks 2 and 3 "
        f"uncompensated, by less than {quiet + 5e-4:.3f} % compensated."
    )
    return f"<p>{html.escape(text)}</p>"


def _table(head: list[str], rows: list[list[str]]) -> str:
    top = "".join(f"<th>{cell}</th>" for cell in head)
    lines = ["<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows]
    return f"<table><tr>{top}</tr>\n" + "\n".join(lines) + "</table>"


def _picture(figure: Figure, alt: str) -> str:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    data = base64.b64encode(buffer.getvalue()).decode("ascii")
    return f'<p><img alt="{html.escape(alt)}" src="data:image/png;base64,{data}"></p>'


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not np.isfinite(value):
        return None
    return value


PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>ICINCO 2010, again</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; max-width: 1100px; margin: 2em auto; padding: 0 1em; color: #222; }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums; margin: 1em 0; }}
th, td {{ padding: 3px 10px; text-align: right; border-bottom: 1px solid #ddd; font-size: 13px; }}
th {{ background: #f4f4f4; }} td:first-child {{ text-align: left; }}
img {{ max-width: 100%; }} h1 {{ font-size: 1.5em; }} h2 {{ font-size: 1.15em; margin-top: 2em; }}
</style></head><body>
{body}
</body></html>
"""
