"""Does a record show that OP moves PV? In a closed loop OP foretells PV even where the valve never moves."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.distributions import f_tail
from lostmotion.identify.news import FEWEST, longest, news, standard
from lostmotion.kernels.triangular import triangular

LEVEL = 1e-4  # of the test, as of whether OP answers PV
OF_SP_LEVEL = 1e-3  # where SP is the news: no act between the rows is taken for a move of it
OF_CONTROLLER = 20  # past rows of OP and PV that tell what the controller did by itself; 10 left a filter of PV over
OF_PV = 30  # past rows of PV that foretell it
OF_SP = 3  # past rows of SP that foretell a ramp of it
# Lags, first and last, over which news are added up: a process answers for as long as it takes to settle.
SPANS = ((1, 1), (2, 2), (3, 4), (5, 8), (9, 16), (17, 32), (33, 64), (65, 128))
# Last lag at which news of OP may be news of PV: a controller that acts between the rows has seen a PV that is in no
# row. Of 450 simulated valves that never move, behind controllers of 2 to 20 acts a row, 53 % seem to answer at some
# lag, 12 % beyond two rows and 7 % beyond four; of 150 with one act a row none, at any (benchmarks/answered.py).
OWN = 4
LONGEST = 8  # spans of lags end within this part of the rows


def pv_answers(u: FloatArray, y: FloatArray, segments: IntArray, sp: FloatArray | None = None) -> bool:
    """Whether what is new in OP is seen in PV afterwards.

    A controller with an integral part remembers PV for longer than any autoregression, so OP foretells PV beside past
    PV although nothing it does arrives there. What arrives there is known by its news only: moves of SP, and what
    neither past OP nor PV explain of OP (operators, feedforward). If PV answers neither, a valve that stands still
    would have left the same record, and no size of lost motion is excluded by it.

    Parameters
    ----------
    u, y : ndarray, shape (n,)
        OP and PV, segments one after the other.
    segments : ndarray, shape (s, 2)
        First row and the row behind the last.
    sp : ndarray, shape (n,), optional
        Set point, where it is known.

    Returns
    -------
    bool
        Also False where the record is too short to tell.

    Notes
    -----
    Granger's test (1969, Econometrica 37) of news on PV, beside 30 past rows of PV; news are added up over spans of
    lags that double. Of 60 loops whose valve never moves (``benchmarks/clean_bill.py``) six had been cleared before
    this was asked, and of 48 in which no fault was named nine were said to exclude some size; now one is (a swing, by
    its form), and none. Of 100 sound valves behind moves of SP as large as the load's deviation 82 are seen to answer,
    of moves twice as large 96 (``benchmarks/answered.py``).

    Examples
    --------
    >>> rng = np.random.default_rng(1)
    >>> load, sp = rng.normal(size=2000).cumsum() / 20.0, np.repeat(rng.normal(size=20), 100)
    >>> pv, op = load + rng.normal(size=2000) / 10.0, np.zeros(2000)
    >>> op = np.cumsum(sp - pv) / 20.0  # the valve stands still: PV is the load
    >>> whole = np.array([[0, 2000]])
    >>> pv_answers(op, pv, whole, sp), pv_answers(op, pv + np.append(0.0, op[:-1]), whole, sp)
    (False, True)
    """
    spans = longest(segments)
    u, y = standard(u), standard(y)
    if sp is not None and float(np.ptp(sp)) > 0.0:
        moves = news(standard(sp), (), spans, OF_SP)
        if _chance(moves, y, spans, 0) < OF_SP_LEVEL:
            return True
    return _chance(news(u, (y,), spans, OF_CONTROLLER), y, spans, OWN) < LEVEL


def _chance(new: FloatArray, y: FloatArray, spans: list[tuple[int, int]], own: int) -> float:
    """That news beyond the lag `own` would tell so much of y, beside its own past and news up to there, by chance."""
    rows_at_most = max(stop - start for start, stop in spans)
    used = [span for span in SPANS if LONGEST * span[1] <= rows_at_most]
    if not used or used[-1][1] <= own:
        return 1.0
    first = max(OF_CONTROLLER + used[-1][1], OF_PV)
    total = np.append(0.0, np.cumsum(new))

    def rows(start: int, stop: int) -> FloatArray:
        now = np.arange(start, stop)
        summed = [total[now - low + 1] - total[now - high] for low, high in used]
        past = y[now[:, None] - np.arange(1, OF_PV + 1)]
        return np.column_stack([np.ones(now.size), past, *summed, y[now]])

    inner = [(start + first, stop) for start, stop in spans if stop - start > first]
    columns, tested = OF_PV + len(used) + 2, sum(high > own for _, high in used)
    samples = sum(stop - start for start, stop in inner)
    free = samples - columns + 1
    if samples < FEWEST * columns:
        return 1.0
    left = triangular(rows, inner, columns)[:, -1] ** 2
    gained, rest = float(left[-1 - tested : -1].sum()), float(left[-1])
    return float(f_tail(gained / tested / max(rest / free, 1e-300), tested, free))
