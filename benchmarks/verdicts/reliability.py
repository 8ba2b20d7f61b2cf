"""Are the probabilities frequencies? Real loops, each contributor judged by weights in whose making he had no part."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from verdicts.calibrate import Array, Weights, features_of, shares, sticks, with_real
from verdicts.cases import Row

EDGES = (0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)
SURE = 0.9


def left_out(prior: Weights, rows: list[Row]) -> Array:
    """Probability of sticking of every row, by weights made without its contributor."""
    chance = np.zeros(len(rows))
    for by in sorted({row.contributor for row in rows}):
        here = np.array([row.contributor == by for row in rows])
        weights = with_real(prior, [row for row in rows if row.contributor != by])
        chance[here] = weights.chance(features_of(rows)[here])
    return chance


def scores(chance: Array, rows: list[Row]) -> tuple[float, float, float, float]:
    """Brier score, area under the curve, and of claims of 0.9 and more (either way) the loops right and all."""
    truth, weight = sticks(rows), shares(rows)
    brier = float(weight @ (chance - truth) ** 2 / weight.sum())
    above = (chance[:, None] > chance) + 0.5 * (chance[:, None] == chance)
    pairs = np.outer(weight * truth, weight * (1.0 - truth))
    claimed = np.maximum(chance, 1.0 - chance) >= SURE
    right = (chance > 0.5) == (truth > 0.5)
    return brier, float((pairs * above).sum() / pairs.sum()), float(weight @ (claimed & right)), float(weight @ claimed)


def score_table(prior: Weights, rows: list[Row]) -> str:
    """Weights of simulated loops alone beside those that real loops moved."""
    lines = [
        "| weights | Brier score | area under the curve | claims of 0.9 and more that are right |",
        "|---|---|---|---|",
    ]
    alone = prior.chance(features_of(rows))
    for name, chance in (
        ("of simulated loops alone", alone),
        ("discounted as the other contributors' loops show", left_out(prior, rows)),
    ):
        brier, area, right, claims = scores(chance, rows)
        lines.append(f"| {name} | {brier:.3f} | {area:.2f} | {right:.1f} of {claims:.1f} loops |")
    return "\n".join(lines)


def diagram(prior: Weights, rows: list[Row]) -> str:
    """Reliability: what was claimed of loops left out, and what is true of them."""
    chance, truth, weight = left_out(prior, rows), sticks(rows), shares(rows)
    lines = ["| claimed probability | loops | mean claim | of them labelled stiction |", "|---|---|---|---|"]
    for low, high in pairwise(EDGES):
        inside = (chance >= low) & ((chance < high) | (high == EDGES[-1]))
        loops = weight[inside].sum()
        if loops > 0.0:
            mean, share = weight[inside] @ chance[inside] / loops, weight[inside] @ truth[inside] / loops
            lines.append(f"| {low:g} to {high:g} | {loops:.1f} | {mean:.2f} | {share:.2f} |")
    return "\n".join(lines)
