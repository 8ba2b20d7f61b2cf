"""Models: frozen values that simulate, invert and write themselves as JSON."""

from lostmotion.models.backlash import Backlash, BacklashInverse
from lostmotion.models.dead_zone import DeadZone, DeadZoneInverse
from lostmotion.models.describing_function import describing_function
from lostmotion.models.hammerstein import Hammerstein, Nonlinearity
from lostmotion.models.identity import Identity
from lostmotion.models.kernel_view import KernelActuator
from lostmotion.models.linear import LinearModel
from lostmotion.models.noise import NoiseModel
from lostmotion.models.registry import actuator_from_dict
from lostmotion.models.saturation import Saturation
from lostmotion.models.series import Series, SeriesInverse
from lostmotion.models.stiction import Stiction

__all__ = [
    "Backlash",
    "BacklashInverse",
    "DeadZone",
    "DeadZoneInverse",
    "Hammerstein",
    "Identity",
    "KernelActuator",
    "LinearModel",
    "NoiseModel",
    "Nonlinearity",
    "Saturation",
    "Series",
    "SeriesInverse",
    "Stiction",
    "actuator_from_dict",
    "describing_function",
]
