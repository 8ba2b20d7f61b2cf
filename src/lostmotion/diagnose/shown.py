"""Whether a record shows the dead zone that fits it, or a valve that sticks would have looked the same."""

from __future__ import annotations

from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit

# of a dead zone that fits: its other side, or that it ends inside the range of OP, the record does not show
NOT_SHOWN = (Status.ONE_SIDED, Status.NEAR_RANGE, Status.NOT_CONVERGED)


def not_shown(fit: HammersteinFit) -> str:
    """Why the record does not show the dead zone of this fit, in words; empty where it does."""
    if not fit.kind.dead_between:
        return ""
    name = fit.kind.name
    if fit.status in NOT_SHOWN:
        return f"a {name} fits, but the record does not show it whole"
    if fit.kind.size is not None and fit.status is Status.WIDE and fit.interval(fit.kind.size)[0] <= 0.0:
        return f"a {name} fits, but of what size, if of any, the record does not tell"
    times = fit.evidence.crossings
    if times is not None and not fit.evidence.crossed_enough:
        often = ("never crosses it", "crosses it once only", "crosses it twice only")
        said = often[times] if times < len(often) else f"crosses it {times} times only"
        return f"a {name} fits, but OP {said}: a valve that sticks could look the same"
    return ""
