"""What is wrong with a loop: known indices, each of one signal or of OP and PV together."""

from lostmotion.diagnose.any_record import diagnose
from lostmotion.diagnose.audit_class import AuditClass, audit_class
from lostmotion.diagnose.bicoherence import Bicoherence, bicoherence_indices
from lostmotion.diagnose.cross_correlation import CrossCorrelation, cross_correlation_index
from lostmotion.diagnose.diagnosis import Diagnosis
from lostmotion.diagnose.ellipse import Ellipse, apparent_stiction
from lostmotion.diagnose.harris import HarrisIndex, harris_index
from lostmotion.diagnose.oscillation import Oscillation, find_oscillation
from lostmotion.diagnose.pooled.pooled_diagnosis import PooledDiagnosis
from lostmotion.diagnose.relay import Relay, relay_index
from lostmotion.diagnose.shape import Shape, shape_index
from lostmotion.diagnose.waveform import Waveform, waveform_index
from lostmotion.diagnose.yamashita import Qualitative, yamashita_index
from lostmotion.records.movement import reversals_per_hour, share_at_limits, travel_per_hour

__all__ = [
    "AuditClass",
    "Bicoherence",
    "CrossCorrelation",
    "Diagnosis",
    "Ellipse",
    "HarrisIndex",
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
    "reversals_per_hour",
    "shape_index",
    "share_at_limits",
    "travel_per_hour",
    "waveform_index",
    "yamashita_index",
]
