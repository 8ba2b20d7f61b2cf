from . import compensate, datasets, evaluate, export, files, models, online, plot, records, report, simulate
from .actuator import ActuatorResponse, actuator_response
from .audit import AuditRun, audit
from .compensate import (
    AdaptiveCompensator,
    BacklashCompensator,
    CompensatorBlock,
    DeadZoneCompensator,
    block_from_model,
    read_block,
)
from .design import Achievable, TestDesign, achievable, design
from .diagnose import Diagnosis, LongDiagnosis, PooledDiagnosis, diagnose
from .errors import (
    ColumnError,
    DataError,
    FileAccessError,
    GateError,
    InputError,
    LostMotionError,
    ParameterError,
    Status,
    TimeError,
)
from .evaluate import CompensationStudy, Solution, compensation_study, control_variance, mean_absolute_error, solve
from .files import read_loop, read_loops
from .identify import ChangeEvent, FitFacts, HammersteinFit, RecursiveIV, RecursiveML, identify, read_fit, run_many
from .models import (
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
from .records import LoopRecord, check
from .simulate import PI, LoopResponse, platforms, routine_operation, signals, simulate_loop

__version__: str

__all__ = [
    "PI",
    "Achievable",
    "ActuatorResponse",
    "AdaptiveCompensator",
    "AuditRun",
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
    "GateError",
    "Hammerstein",
    "HammersteinFit",
    "Identity",
    "InputError",
    "LinearModel",
    "LongDiagnosis",
    "LoopRecord",
    "LoopResponse",
    "LostMotionError",
    "NoiseModel",
    "ParameterError",
    "PooledDiagnosis",
    "RecursiveIV",
    "RecursiveML",
    "Saturation",
    "Series",
    "Solution",
    "Status",
    "Stiction",
    "TestDesign",
    "TimeError",
    "achievable",
    "actuator_response",
    "audit",
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
    "read_loops",
    "routine_operation",
    "run_many",
    "signals",
    "simulate_loop",
    "solve",
]
