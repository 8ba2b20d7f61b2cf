"""lostmotion finds the lost motion of industrial actuators in the records of their control loops.

The main job in one line: record -> identify -> compensate -> simulate -> export.

>>> import lostmotion as lm
>>> valve = lm.DeadZone(left=-1.0, right=1.0, left_slope=3.0, right_slope=3.0)
>>> valve(2.0)
3.0
"""

from lostmotion import plot as _plot  # noqa: F401  registers figures
from lostmotion import report as _report  # noqa: F401  registers summaries
from lostmotion.compensate import (
    AdaptiveCompensator,
    BacklashCompensator,
    CompensatorBlock,
    DeadZoneCompensator,
    block_from_model,
    read_block,
)
from lostmotion.design import Achievable, TestDesign, achievable, design
from lostmotion.diagnose import Diagnosis, diagnose
from lostmotion.errors import (
    ColumnError,
    DataError,
    FileAccessError,
    InputError,
    LostMotionError,
    ParameterError,
    Status,
    TimeError,
)
from lostmotion.evaluate import CompensationStudy, compensation_study, control_variance, mean_absolute_error
from lostmotion.files import read_loop
from lostmotion.identify import (
    ChangeEvent,
    FitFacts,
    HammersteinFit,
    RecursiveIV,
    RecursiveML,
    identify,
    read_fit,
    run_many,
)
from lostmotion.models import (
    Backlash,
    DeadZone,
    Hammerstein,
    Identity,
    LinearModel,
    NoiseModel,
    Saturation,
    Series,
    Stiction,
    describing_function,
)
from lostmotion.records import LoopRecord, check
from lostmotion.simulate import PI, LoopResponse, platforms, routine_operation, signals, simulate_loop

__version__ = "0.1.0"

__all__ = [
    "PI",
    "Achievable",
    "AdaptiveCompensator",
    "Backlash",
    "BacklashCompensator",
    "ChangeEvent",
    "ColumnError",
    "CompensationStudy",
    "CompensatorBlock",
    "DataError",
    "DeadZone",
    "DeadZoneCompensator",
    "Diagnosis",
    "FileAccessError",
    "FitFacts",
    "Hammerstein",
    "HammersteinFit",
    "Identity",
    "InputError",
    "LinearModel",
    "LoopRecord",
    "LoopResponse",
    "LostMotionError",
    "NoiseModel",
    "ParameterError",
    "RecursiveIV",
    "RecursiveML",
    "Saturation",
    "Series",
    "Status",
    "Stiction",
    "TestDesign",
    "TimeError",
    "achievable",
    "block_from_model",
    "check",
    "compensation_study",
    "control_variance",
    "describing_function",
    "design",
    "diagnose",
    "identify",
    "mean_absolute_error",
    "platforms",
    "read_block",
    "read_fit",
    "read_loop",
    "routine_operation",
    "run_many",
    "signals",
    "simulate_loop",
]
