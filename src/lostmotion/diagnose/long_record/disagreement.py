"""Why looks that do not all say the same tell nothing, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence

from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.op_span import op_span

COUNT = {2: "two", 3: "three"}


def about_looks(seen: Sequence[Diagnosis]) -> str:
    """One sentence on looks of which some name a fault and another does not; "cannot tell" contradicts nothing.

    Of several that name one, beside others that cannot tell: they are too weak together.
    """
    told = [one for one in seen if one.verdict != "cannot tell"]
    if any(one.kind != "actuator" for one in told):
        return f"stretches of the record disagree: {' and '.join(repr(one.verdict) for one in told)}"
    count, silent = COUNT.get(len(seen), str(len(seen))), "the other" if len(seen) == len(told) + 1 else "the others"
    if len(told) > 1:
        faults = " and ".join(dict.fromkeys(f"a {one.verdict}" for one in told))
        number = COUNT.get(len(told), str(len(told)))
        return f"{number} of {count} stretches show {faults}, {silent} cannot tell: together not likelier than none"
    return f"one of {count} stretches shows a {told[0].verdict}{_size(told[0])}, {silent} cannot tell"


def _size(found: Diagnosis) -> str:
    if not math.isfinite(found.size_percent):
        return ""
    return f" of {found.size_percent:.2g} % {op_span(found.record).words}"
