"""No fault: the actuator does what it is told."""

from __future__ import annotations

import numpy as np

from lostmotion.identify.actuators.kind import Kind, Words, register
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.family import Family, LinearFamily
from lostmotion.identify.scaled import ScaledData
from lostmotion.models import Identity


class NoFaultKind(Kind):
    """What every fault must beat."""

    model = Identity
    family = LinearFamily
    evidence = "dead_zone"  # of no weight: it is what others are weighed against
    angular = "never"
    words = Words()

    def forms(self, data: ScaledData) -> list[Family]:
        """No parameters."""
        del data
        return [LinearFamily()]

    def sought(self, data: ScaledData, asked: Asked) -> Sought:
        """Nothing is to be sought."""
        del data, asked
        return Sought(LinearFamily(), [np.zeros(0)], float(np.inf))


NONE = register(NoFaultKind())
