from .any_record import diagnose
from .audit_class import AuditClass, audit_class
from .bicoherence import Bicoherence, bicoherence_indices
from .cross_correlation import CrossCorrelation, cross_correlation_index
from .diagnosis import Diagnosis
from .ellipse import Ellipse, apparent_stiction
from .harris import HarrisIndex, harris_index
from .long_record.long_diagnosis import LongDiagnosis
from .oscillation import Oscillation, find_oscillation
from .pooled.pooled_diagnosis import PooledDiagnosis
from .relay import Relay, relay_index
from .shape import Shape, shape_index
from .waveform import Waveform, waveform_index
from .yamashita import Qualitative, yamashita_index

__all__ = [
    "AuditClass",
    "Bicoherence",
    "CrossCorrelation",
    "Diagnosis",
    "Ellipse",
    "HarrisIndex",
    "LongDiagnosis",
    "Oscillation",
    "PooledDiagnosis",
    "Qualitative",
    "Relay",
    "Shape",
    "Waveform",
    "apparent_stiction",
    "audit_class",
    "bicoherence_indices",
    "cross_correlation_index",
    "diagnose",
    "find_oscillation",
    "harris_index",
    "relay_index",
    "shape_index",
    "waveform_index",
    "yamashita_index",
]
