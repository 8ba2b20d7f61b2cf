"""Models: frozen values that simulate, invert and write themselves as JSON."""

from lostmotion.models.dead_zone import DeadZone, DeadZoneInverse
from lostmotion.models.hammerstein import Hammerstein, Nonlinearity
from lostmotion.models.identity import Identity
from lostmotion.models.linear import LinearModel
from lostmotion.models.noise import NoiseModel

__all__ = [
    "DeadZone",
    "DeadZoneInverse",
    "Hammerstein",
    "Identity",
    "LinearModel",
    "NoiseModel",
    "Nonlinearity",
]
