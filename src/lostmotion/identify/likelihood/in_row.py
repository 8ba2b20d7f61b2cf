"""Does PV answer OP within a row? A flow that is recorded more slowly than its loop has settled before the next row."""

from __future__ import annotations

import numpy as np

from lostmotion.identify.likelihood.arx import fit_arx
from lostmotion.identify.likelihood.feedback import SURE_BY_SP, feedback
from lostmotion.identify.likelihood.remembered import remembered
from lostmotion.identify.scaled import ScaledData

SURE = 10.0  # standard errors of the answer
LEAST = 0.05  # share of it in all answers of an ARX: 0.02 to 0.04 where a row has two or four scans of the controller


@remembered
def answers_in_row(data: ScaledData) -> bool:
    """Whether in a closed loop a delay of 0 is a process, not the controller that ties PV and OP of one row.

    The controller makes OP of PV, and PV seems to answer OP by its inverse, in the direction of the controller; a
    process must answer the other way for the feedback to be negative. That needs the direction from elsewhere: from
    moves of the set point. Where the controller knows PV of the rows before only, nothing ties them but the process.
    """
    loop = feedback(data)
    if not loop.closed or data.of_past_rows:
        return loop.closed
    if abs(data.against_pv) <= SURE_BY_SP:
        return False
    arx = fit_arx(data, data.u, 0)
    first = arx.b[0] / np.sqrt(max(arx.covariance[arx.a.size, arx.a.size] * arx.variance, 1e-300))
    share = abs(arx.b[0]) / max(float(np.abs(arx.b).sum()), 1e-300)
    return bool(loop.direction * first < -SURE and share > LEAST)
