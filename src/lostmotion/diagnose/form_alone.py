"""May the form of a swing name a valve? Not where a load of that form would have left the same record."""

from __future__ import annotations

import math

from lostmotion.diagnose.features import Measured
from lostmotion.identify.actuators.kind import faults

# of memory = log(1 + gain / 3), below which no valve that sticks foretells PV better by what a fault needs
BETTER = math.log(2.0)
# of `lopsided_index` of OP: a saw tooth behind an integrator has it, and a triangle that falls twice as long as it
# rises.
# Named by form alone: two real valves that stuck 0.16 and 0.21, ten simulated ones 0.02 to 0.21; healthy ones behind
# loads that are saw teeth 0.29 to 0.56. Of 54 loops behind saw teeth and pumps drawn after that 14 were accused, all
# withdrawn here, and none of 20 rightly accused ones. Where friction one way is up to three times that of the other, 3
# of 113 valves behind a level were above it
LOPSIDED = 0.25
# of memory, from which on a valve that sticks is named however lopsided: a gain of 30. Behind saw teeth of load, where
# nothing but PV moves OP, healthy valves gained up to 15; of 120 other loops one that stuck had 0.26, and gained 356
FORETOLD = math.log(11.0)
# of the labelled real loops one was named so, and did not stick (CHEM34); of 900 simulated ones one, rightly
NOTHING_SWINGS = (
    "no valve that sticks foretells PV better by what counts, and nothing swings regularly, so that there is no form"
    " of a swing to go by"
)
AS_A_LOAD = "one half of the swing of OP is not the other upside down, as a saw tooth of load or a pump makes it"
NO_BETTER = "no valve that sticks foretells PV better"
ONLY_FED_BACK = "PV foretells all that moves OP, so that the record does not tell process and valve from the load"


def without_proof(verdict: str, measured: Measured, level: bool, fed_back: bool) -> str:
    """Why a verdict rests on a form that a load has as well, in words; empty where it does not.

    A valve that sticks alike both ways under a steady load makes a cycle whose second half is the first upside down:
    integral action moves its mean until it is. A saw tooth of load, or a pump that runs a third of the time, does not,
    and behind a level the controller follows it in triangles.

    Parameters
    ----------
    verdict : str
        As it would be.
    measured : Measured
    level : bool
        Whether the process answers as a level.
    fed_back : bool
        Whether PV foretells all that moves OP.
    """
    kind = next((one for one in faults() if one.name == verdict), None)
    if kind is None or kind.size is None:
        return ""
    by_form = kind.sticks and measured.features.memory < BETTER
    if by_form and not measured.swings:
        return NOTHING_SWINGS
    lopsided = measured.indices.get("lopsided_op", 0.0) > LOPSIDED
    foretold = kind.sticks and measured.features.memory >= FORETOLD
    if level and lopsided and (by_form or fed_back) and not foretold:
        return f"{AS_A_LOAD}; {NO_BETTER if by_form else ONLY_FED_BACK}"
    return ""
