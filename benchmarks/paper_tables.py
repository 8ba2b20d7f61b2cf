"""The paper's tables as a page of the documentation.

Run: ``.venv/bin/python benchmarks/paper_tables.py`` (about 2 minutes on two cores); writes docs/paper.md.
"""

from __future__ import annotations

from pathlib import Path

from lostmotion.paper import ControlStudy, EstimationStudy, study_control, study_estimation, to_dict
from lostmotion.paper.published import SYMBOLS, TABLE_1, TABLE_2
from pages import publish

OUTPUT = Path(__file__).parent.parent / "docs" / "paper.md"
METHODS = ("riv", "rls", "els", "voros", "ml")
NAMES = ("right_slope", "left_slope", "right", "left", "a1", "b0")


def table_1(study: EstimationStudy) -> str:
    found = {method: study.summary(method) for method in METHODS}
    lines = []
    for name in NAMES:
        estimate, real = TABLE_1[name]
        cells = [SYMBOLS.get(name, name), f"{abs(estimate - real):.5f}"]
        cells += [f"{found[method]['rmse'][name]:.5f}" for method in METHODS]
        lines.append(cells)
    lines.append(["converged", ""] + [f"{found[m]['converged']}/{found[m]['seeds']}" for m in METHODS])
    times = [found[method]["convergence_time_s"] for method in METHODS]
    lines.append(
        ["dead zone within 10 % after", "7,500 s (all)"]
        + ["batch" if value is None else f"{value:,.0f} s" for value in times]
    )
    return rows(lines)


def many_seeds() -> str:
    lines = []
    for samples in (20_000, 200_000):
        found = study_estimation(100, samples, ("riv",)).summary("riv")
        cells = [f"{samples:,}", f"{found['converged']}/100"] + [f"{found['rmse'][name]:.4f}" for name in NAMES[:4]]
        lines.append([*cells, f"{found['convergence_time_s']:,.0f} s"])
    return rows(lines)


def table_2(study: ControlStudy) -> str:
    lines = []
    for track, cases in TABLE_2.items():
        for case in ("without", "with", "ideal"):
            mean, spread, published = study.mean(case, track), study.spread(case, track), cases.get(case)
            cells = [str(track), {"ideal": "no dead zone"}.get(case, f"{case} compensation")]
            for index in (0, 1):
                cells.append("" if published is None else f"{published[index]:.4f}")
                cells.append(f"{mean[index]:.4f} ({spread[index]:.4f})")
            cells.append("" if published is None else f"{mean[1] / published[1]:.3f}")
            lines.append(cells)
    return rows(lines)


def rows(lines: list[list[str]]) -> str:
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def main() -> None:
    estimation, control = study_estimation(20, 200_000, METHODS), study_control(200)
    data = to_dict(estimation, control)
    rls = estimation.summary("rls")
    bias, error = rls["mean"]["right_slope"] - 3.0, rls["standard_error"]["right_slope"]
    ratio = {name: estimation.spread("riv", name)[2] / estimation.spread("ml", name)[2] for name in ("left", "right")}
    publish(
        OUTPUT,
        PAGE.format(
            table_1=table_1(estimation),
            slope=rls["mean"]["right_slope"],
            bias=abs(bias) / error,
            left=ratio["left"],
            right=ratio["right"],
            seeds=many_seeds(),
            table_2=table_2(control),
            iae=data["iae"],
            cycle=data["limit_cycle"],
        ),
    )
    print(OUTPUT.read_text(encoding="utf-8"))


PAGE = """# The paper's tables, again

Made by `.venv/bin/python benchmarks/paper_tables.py`: 20 seeds of 200,000 samples, 200 noise sequences. The page with
all figures comes from `lostmotion paper`. What was unclear in the print: [equations.md](equations.md).

## Table 1: RMSE over the seeds, beside the error of the paper's single run

| | paper, 1 run | RIV | least squares | extended LS | Voros | `identify` |
|---|---|---|---|---|---|---|
{table_1}

Least squares: mr = {slope:.3f} instead of 3, {bias:.0f} of its own standard errors away. The break-point errors of
`identify` are {left:.0f} (left) and {right:.0f} (right) times smaller than those of RIV on the same data.

RIV with 100 seeds:

| samples | converged | RMSE mr | ml | br | bl | zone within 10 % after (median) |
|---|---|---|---|---|---|---|
{seeds}

The paper's errors of ml and bl (0.007 and 0.0044) are those of one run; by symmetry the method is as uncertain there
as at mr and br. As printed (`form="printed"`) no run converges.

## Table 2

| track | case | eps1 paper | eps1 here (spread) | eps2 paper | eps2 here (spread) | eps2 ratio |
|---|---|---|---|---|---|---|
{table_2}

The spread is from one noise sequence to the next; the paper has one. eps1 of tracks 2 and 3 depends on a few sign
changes of the controller output near zero in that one run: each makes the inverse jump by br - bl.

IAE over all tracks: without dead zone {iae[ideal]:.4f}, compensated with table 1's estimates {iae[with]:.4f},
uncompensated {iae[without]:.4f}. Without noise the level swings by {cycle[without 2]:.2f} % and
{cycle[without 3]:.2f} % in tracks 2 and 3 uncompensated, by {cycle[with 2]:.1g} % and {cycle[with 3]:.1g} %
compensated.
"""


if __name__ == "__main__":
    main()
