"""Other sizes of a sticking valve that explain a record nearly as well as the one that was found.

Where friction is none of the models, as that of a valve which breaks away between two rows and stops at once, each of
them explains a part of the record at a place of its own: a later slip behind a shorter delay, a smaller band with a
larger jump. Which is likeliest is then decided by what the model lacks, and an interval about one place is too narrow.
"""

from __future__ import annotations

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.identify.actuators.loads import without_their_effect
from lostmotion.identify.actuators.operator_profile import AUTO_LAGS
from lostmotion.identify.actuators.slip_profile import profile_of, slips_of
from lostmotion.identify.actuators.stiction_family import own
from lostmotion.identify.likelihood.arx_gram import Lags
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.scaled import ScaledData

# of what the likeliest place gains over a valve that follows OP: a place that gains so much less is as good where the
# model is none of the valve. Of ten limit cycles of valves with mass and friction, simulated in fine steps with the set
# point at rest, whose interval about one place missed the size, the true one was so near in six
MODEL_SHARE = 0.15


def rival_places(fitted: Fitted) -> list[FloatArray]:
    """Bands and jumps (scaled) of places that are nearly as likely in the profile as the fit and the best of it."""
    problem = fitted.problem
    data = without_their_effect(fitted, ScaledData(problem.u, problem.y, problem.segments))
    first = min(problem.structure.delay, 1)
    lags = Lags.for_record(data.shortest, first, inputs=AUTO_LAGS)
    found, whole = slips_of(data, lags), profile_of(data, lags)
    band, jump = fitted.actuator.tolist()
    family = own(problem.family)
    rests = (*family.rests, *[0.0] * (len(found[0].rests) - len(family.rests)))[: len(found[0].rests)]
    costs = [place.cost for place in found]
    costs.append(whole.place(family.code, band, jump, rests).cost)
    limit = whole.linear - (1.0 - MODEL_SHARE) * (whole.linear - min(costs))
    return [np.array([place.band, place.jump]) for place in found if place.cost <= limit]
