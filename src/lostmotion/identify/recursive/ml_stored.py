"""What the bytes of a RecursiveML may hold: its kernels look neither where they write nor at what they read."""

from __future__ import annotations

from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.schema import LARGEST, LARGEST_WHOLE, anything, checked, each, flag, group, number, text, whole
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.kernels.recursive_ml import drift
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.recursive_ml.watch import ROUNDED

MOST_ORDER, MOST_START = 1000, 10_000_000  # orders and samples of a first window: more are no loop's
LONGEST_SETTLING = 1_000_000_000
COUNTED = (
    ml.BLOCKS, ml.LOST, ml.SINCE, ml.LEFT_AT, ml.RIGHT_AT, ml.CLIPPED, ml.MASKED, ml.PERIOD_FROM, ml.FAR,
    ml.JUDGED,
)  # fmt: skip
TUNED = (ml.TAIL, ml.KEEP, ml.CLIP, ml.THRESHOLD, ml.RATIO_LIMIT)
MAY_BE_MISSING = ("u", "y", "watch", "repeats")
EVENT = group(
    sample=whole(), since=whole(-LARGEST_WHOLE), name=text(40), before=number(), after=number(), standard_error=number()
)
HEADER = group(
    {"integrating": flag()},
    format=text(100), settings=anything, seen=whole(), next_try=whole(), events=each(EVENT, 100),
)  # fmt: skip


def check_header(header: Any) -> dict[str, Any]:
    """Header of the bytes; DataError where it is none."""
    checked_header: dict[str, Any] = checked(header, HEADER, "an estimator", "start anew")
    return checked_header


def check_settings(settings: Settings) -> None:
    """ValueError where they would ask for more memory than a loop can need."""
    orders = (*settings.orders, settings.noise if isinstance(settings.noise, int) else 0)
    if max(orders) > MOST_ORDER or settings.start_samples > MOST_START:
        raise ValueError("settings")


def check_window(gathered: FloatArray, settings: Settings, seen: int) -> None:
    """ValueError where the gathered samples are none."""
    good = gathered.dtype == np.float64 and gathered.ndim == 2 and len(gathered) == 2
    if not good or gathered.shape[1] > min(seen, 16 * settings.start_samples):
        raise ValueError("gathered")
    if not _plain(gathered[~np.isnan(gathered)]):
        raise ValueError("gathered")


def check_scales(scales: FloatArray) -> None:
    """ValueError where they are no two positive numbers."""
    if scales.shape != (2,) or scales.dtype != np.float64 or not (_plain(scales) and (scales > 1.0 / LARGEST).all()):
        raise ValueError("scales")


def check_recursion(settings: Settings, state: FloatArray, layout: IntArray) -> None:
    """ValueError where the arrays do not fit the settings, or hold what a recursion never holds."""
    if layout.shape != (ml.LAYOUT_SIZE,) or layout.dtype != np.int64:
        raise ValueError("layout")
    p = int(layout[ml.P])
    if not 0 <= p * p < state.size:
        raise ValueError("layout")
    made_state, made_layout = settings.tuning.allocate(settings.orders, p)
    if state.shape != made_state.shape or state.dtype != made_state.dtype:
        raise ValueError("state")
    fixed = [*ml.NOT_MOVING, ml.TEST_AFTER]
    if not np.array_equal(layout[fixed], made_layout[fixed]):
        raise ValueError("layout")
    _check_counters(layout)
    tuned = list(TUNED)
    if not np.allclose(state[tuned], made_state[tuned], rtol=1e-6, atol=0.0):
        raise ValueError("state")
    _check_values(state, layout)


def _check_counters(layout: IntArray) -> None:
    count = int(layout[ml.COUNT])
    most = {
        **dict.fromkeys(COUNTED, count), ml.FILLED: layout[ml.BLOCK] - 1, ml.WINDOW: layout[ml.RING],
        ml.WAIT: layout[ml.P] + 1, ml.SETTLE: LONGEST_SETTLING, ml.REFIT_AT: ml.NEVER, ml.DRIFT: ml.DRIFTS - 1,
        ml.GROUPED: drift.GROUP - 1, ml.EXPLAIN_AT: count + layout[ml.RING], ml.FROM_BLOCK: count,
        ml.MISSING: 2 * count,  # values of OP and of PV
    }  # fmt: skip
    if not 0 <= count <= LARGEST_WHOLE:
        raise ValueError("counters")
    for counter, largest in most.items():
        if not -(counter == ml.SETTLE) <= layout[counter] <= largest:
            raise ValueError("counters")


def _check_values(state: FloatArray, layout: IntArray) -> None:
    """Finite but where a sample may be missing or something not have happened yet."""
    parts = ml.named(state, layout)
    watch = parts["watch"].copy()
    if watch[ml.GAP] == np.inf:
        watch[ml.GAP] = 0.0
    for name, values in {**parts, "watch": watch}.items():
        if not _plain(values[~np.isnan(values)] if name in MAY_BE_MISSING else values):
            raise ValueError(name)
    head = state[[ml.SQUARES, ml.WEIGHT, ml.LOW, ml.HIGH, ml.HELD]]
    if not (_plain(head) and head[0] >= 0.0 and head[1] > 0.0 and head[2] <= head[3]):
        raise ValueError("state")
    again, share = parts["repeats"][[ml.REPEATED, ml.SHARE]]
    if not (again >= 0.0 and (0.0 <= share <= 1.0 or share == ROUNDED)):
        raise ValueError("repeats")
    if not (np.isnan(state[ml.ZERO]) or state[ml.ZERO] in (0.0, 1.0)):
        raise ValueError("state")


def _plain(values: FloatArray) -> bool:
    """Finite numbers whose squares are numbers."""
    return bool((np.abs(values) <= LARGEST).all())
