"""What speaks for the actuator."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Evidence:
    """Comparison of the models that were fitted to the same rows.

    Attributes
    ----------
    gain_over_linear : float
        BIC(linear) - BIC(this model): above 0 favours this model, above 10 strongly. 0 for a linear fit.
    gain_over_no_input : float
        BIC(autoregression of PV alone) - BIC(linear): below 0 OP hardly moves PV.
    samples_left, samples_right : int
        Rows in which OP is beyond the break points.
    rivals : tuple of (left, right, behind)
        Other dead zones that fit about as well, and by how much BIC they are behind (rough fits).
    closed_loop : bool
        OP answers PV.
    free_moves : float
        Share of the moves of OP that PV does not explain (set-point moves, tests, operators).
    other_kind : (str, float) or None
        Kind that is likelier than the one asked for, and by how much log-likelihood, less what parameters cost.
    crossings : (int, int) or None
        Times that OP went from the middle of a dead zone beyond its left and its right break point; None: no dead zone,
        or a fit saved before they were counted.
    """

    gain_over_linear: float
    gain_over_no_input: float
    samples_left: int
    samples_right: int
    rivals: tuple[tuple[float, float, float], ...] = ()
    closed_loop: bool = False
    free_moves: float = 1.0
    other_kind: tuple[str, float] | None = None
    crossings: tuple[int, int] | None = None
