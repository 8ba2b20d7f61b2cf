"""Whether a record shows the fault that fits it, or something else would have looked the same."""

from __future__ import annotations

import numpy as np

from lostmotion.diagnose.excitation import what_moves_op
from lostmotion.errors import Status
from lostmotion.identify import HammersteinFit
from lostmotion.models import Saturation, Stiction
from lostmotion.records.sampling import runs

# of a dead zone that fits: its other side, or that it ends inside the range of OP, the record does not show
NOT_SHOWN = (Status.ONE_SIDED, Status.NEAR_RANGE, Status.NOT_CONVERGED)

DOUBTFUL = (Status.MISFIT, Status.COLOURED)  # of a model: what it leaves over is not white, and its gain no evidence
# firm gain in log-likelihood, from which on a doubtful fault leaves open what denies it. In the labelled real loops
# four such gains, 3 to 27, were set aside, each time rightly; a larger one there was not
SEEN_TO_MISLEAD = 30.0

# At a stop the integral of a controller runs on: OP ranges over so many times the stroke that the stops leave, and
# stays beyond one for so many rows. In six real runs (of ISDB, SACAC, a refinery) stops inside the range of OP fitted
# best, and there were none: 1.4 to 5.3 times, 7 to 25 rows, once 523. Of 43 simulated loops behind true stops 40 reach
# both.
FAR, LONG = 3.0, 40
NARROW = 0.02  # of the range of OP: a valve that moves by less than this from stop to stop passes nothing
# Swings and steps of load beside the process: where there are more, and they with it do not reproduce PV, they tell the
# record one step ahead, not OP. So a backlash of 7 % of span was excluded down to 0.4 % in an independent simulation
MOST_LOADS = 12
# The same for a size: valves that climb in stairs, behind a load that drifts, show the jump and hardly the band. Of 35
# sizes of valves that stick behind models that reproduce nothing 10 of 16 were wrong with 7 loads and more, of up to 3
# loads 1 of 19 (loops after published papers)
MANY_LOADS = 6
ONE_SIGNAL = "OP is PV times a number, as of a proportional controller at a set point at rest: nothing else moves OP"
# Rows about a move of SP, and times that chance would put steps of load there: in an independent simulation 13 of 14
# steps of a sound model stood there, did what the valve failed to do, and stiction of 5 % was excluded down to 0.02
BEFORE, BEHIND, OFTEN, FEW = 2, 10, 4.0, 4
NO_STROKE = "limits of the valve fit, but so near to each other that it is no stroke: one edge of a dead zone would fit"
NO_STOP = "limits of the valve fit, but OP never runs far beyond them and stays there, as a controller does at a stop"


def not_shown(fit: HammersteinFit) -> str:
    """Why the record does not show the fault of this fit, in words; empty where it does.

    Neither a valve that sticks in a loop that settles between the rows, which look the same behind a sound one, nor one
    whose interval begins at 0, moves aside that may not be: in an independent simulation four of five such claims were
    of sound valves. Nor one that
    slips between the rows where nothing but PV moves OP and it leaves a structure over: two positions that a controller
    goes between are what a saw tooth of load, and a valve that sticks upstream, look like (0.99 and 0.88). Nor a dead
    zone of little gain where OP foretells PV against the valve, and what stands for the process is none: 0.6 % of span
    before a backlash of 7 %, 0.81 sure.
    """
    if fit.status is Status.SAME_SIGNAL:
        return ONE_SIGNAL
    actuator = fit.model.nonlinearity
    if isinstance(actuator, Saturation):
        return _no_stops(fit, actuator)
    name = fit.kind.name
    if fit.kind.sticks and fit.data.unseen.settled:
        return f"a {name} fits, but the loop settles between the rows, which do not show how far OP went there"
    vague = fit.kind.sticks or fit.status is Status.WIDE
    if fit.kind.size is not None and vague and fit.least_known <= 0.0:
        return f"a {name} fits, but of what size, if of any, the record does not tell"
    if isinstance(actuator, Stiction) and actuator.model == "he ramp" and _as_loads(fit):
        moved = what_moves_op(fit.data.sp)
        return f"a {name} fits, but so would loads in steps: {moved}, and the fit leaves something over"
    if not fit.kind.dead_between:
        return ""
    if fit.status in NOT_SHOWN:
        return f"a {name} fits, but the record does not show it whole"
    if fit.evidence.foreknown and _firm(fit) < SEEN_TO_MISLEAD:
        return f"a {name} fits, but the controller knows more than the rows show, and that fits as well"
    times = fit.evidence.crossings
    if times is not None and not fit.evidence.crossed_enough:
        often = ("never crosses it", "crosses it once only", "crosses it twice only")
        said = often[times] if times < len(often) else f"crosses it {times} times only"
        return f"a {name} fits, but OP {said}: a valve that sticks could look the same"
    return ""


def not_deniable(fit: HammersteinFit) -> str:
    """Why a large gain of this fit neither names its fault nor lets deny it, in words; empty where it names it."""
    gain = _firm(fit)
    if fit.status not in DOUBTFUL or gain < SEEN_TO_MISLEAD:
        return ""
    return (
        f"a {fit.kind.name} predicts PV far better ({gain:+.0f}), too much to deny it, but what it leaves over is not"
        " white, which is too little to name it"
    )


def only_one_step_ahead(fit: HammersteinFit, loads: int = MOST_LOADS) -> bool:
    """Whether a model with more than so many swings and steps of load tells the record one step ahead, OP nothing."""
    return len(fit.chosen.loads) > loads and fit.fit_percent <= 0.0


def _no_stops(fit: HammersteinFit, stops: Saturation) -> str:
    """Why the record does not show the stops of this fit; empty where it does."""
    if stops.high - stops.low < NARROW * float(np.ptp(fit.data.u)):
        return NO_STROKE
    return "" if not fit.evidence.closed_loop or _wound_up(fit, stops) else NO_STOP


def loads_at_moves(fit: HammersteinFit) -> bool:
    """Whether steps of load stand where SP moves far more often than by chance: they may be the valve's."""
    steps = np.array([load["step_at"] for load in fit.chosen.loads if "step_at" in load])
    if fit.data.sp is None or steps.size < FEW:
        return False
    moves = 1 + np.flatnonzero(np.diff(fit.data.sp))
    near = np.zeros(fit.data.u.size, bool)
    for move in moves:
        near[max(move - BEFORE, 0) : move + BEHIND + 1] = True
    count = int(np.count_nonzero(near[np.minimum(steps.astype(int), near.size - 1)]))
    return count >= max(FEW, OFTEN * steps.size * float(near.mean()))


def _firm(fit: HammersteinFit) -> float:
    """Firm gain in log-likelihood of its kind; 0 where kinds were not compared."""
    return fit.kinds.firm.get(fit.kind.name, 0.0) if fit.kinds is not None else 0.0


def _as_loads(fit: HammersteinFit) -> bool:
    return fit.evidence.only_fed_back and fit.status in DOUBTFUL


def _wound_up(fit: HammersteinFit, stops: Saturation) -> bool:
    """Whether OP went far beyond a limit and stayed there."""
    low, high = stops.low, stops.high
    parts = [fit.data.u[begin:stop] for begin, stop in fit.data.segments]
    stays = [runs(beyond)[1].max(initial=0) for part in parts for beyond in (part < low, part > high)]
    return max(stays) >= LONG and float(np.ptp(fit.data.u)) >= FAR * (high - low)
