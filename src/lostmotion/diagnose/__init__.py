"""What is wrong with a loop: known indices, each of one signal or of OP and PV together."""

from lostmotion.diagnose.bicoherence import Bicoherence, bicoherence_indices
from lostmotion.diagnose.cross_correlation import CrossCorrelation, cross_correlation_index
from lostmotion.diagnose.ellipse import Ellipse, apparent_stiction
from lostmotion.diagnose.oscillation import Oscillation, find_oscillation
from lostmotion.diagnose.relay import Relay, relay_index
from lostmotion.diagnose.shape import Shape, shape_index
from lostmotion.diagnose.yamashita import Qualitative, yamashita_index

__all__ = [
    "Bicoherence",
    "CrossCorrelation",
    "Ellipse",
    "Oscillation",
    "Qualitative",
    "Relay",
    "Shape",
    "apparent_stiction",
    "bicoherence_indices",
    "cross_correlation_index",
    "find_oscillation",
    "relay_index",
    "shape_index",
    "yamashita_index",
]
