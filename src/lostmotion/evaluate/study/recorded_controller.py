"""The controller of the loop: given, or estimated from the record where feedback is exact."""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.loop_stability import EXACT, estimate_pi
from lostmotion.errors import DataError
from lostmotion.identify.data import collect
from lostmotion.records import LoopRecord, prepare
from lostmotion.simulate import PI


def controller_of(record: LoopRecord) -> tuple[PI, str]:
    """PI that explains the moves of OP, and where it comes from in words.

    Raises
    ------
    DataError
        A PI leaves more than a twentieth of the moves of OP unexplained.
    """
    prepared = prepare(record)
    data = collect(prepared, None, None)
    found = estimate_pi(data, set_point(record))
    if found.unexplained >= EXACT:
        got = f"one that leaves {100.0 * min(found.unexplained, 1.0):.0f} % of them unexplained"
        remedy = "give kp and ki of the controller, or a record with its SP"
        raise DataError.expected("a record whose moves of OP a PI explains", got, remedy)
    controller = PI(found.kp, found.ki / data.dt)
    return controller, (
        f"estimated from the record: a PI explains {100.0 * (1.0 - found.unexplained):.2f} % of the moves of OP"
    )


def set_point(record: LoopRecord) -> FloatArray | None:
    """Set point on the rows that are used; None where it is not known in all of them."""
    stretches = prepare(record).require()
    parts = [stretch.sp for stretch in stretches if stretch.sp is not None]
    if len(parts) < len(stretches):
        return None
    sp = np.concatenate(parts)
    return sp if bool(np.isfinite(sp).all()) else None


def longest_set_point(record: LoopRecord) -> FloatArray | None:
    """Set point of the longest stretch that is used, where it is known."""
    sp = max(prepare(record).require(), key=len).sp
    return sp if sp is not None and bool(np.isfinite(sp).all()) else None
