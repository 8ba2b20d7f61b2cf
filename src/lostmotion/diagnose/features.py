"""The numbers on which a verdict rests, measured once for a record."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.diagnose.bicoherence import bicoherence_indices
from lostmotion.diagnose.cross_correlation import cross_correlation_index
from lostmotion.diagnose.ellipse import apparent_stiction
from lostmotion.diagnose.lopsided import lopsided_index
from lostmotion.diagnose.oscillation import BAND, FEWEST_CYCLES, LEAST_SHARE, Oscillation, find_oscillation
from lostmotion.diagnose.relay import relay_index
from lostmotion.diagnose.shape import shape_index
from lostmotion.diagnose.shown import DOUBTFUL, not_shown
from lostmotion.diagnose.waveform import waveform_index
from lostmotion.errors import DataError
from lostmotion.identify import HammersteinFit
from lostmotion.identify.actuators.kind import NEEDED, NO_FAULT, faults
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.left_open import largest_known

SHORTEST_PERIOD = 10.0  # samples: below it a wave has no shape
SAME = 0.1  # relative difference of two periods that are one
FOLLOWED = 0.97  # coherence of SP and PV near the period: of a swing that comes from elsewhere as well it is up to 0.95
COMMANDED = 0.5  # amplitude of SP over that of PV near the period, from which on the swing is commanded
MOST_ROWS = 10_000  # of the indices: they need cycles, not samples
MOST_ODDS = 4.0  # of the waveform index: beyond them its simulated loops do not speak for real ones
# of the swing of OP from end to end: where a lost motion makes a loop swing, OP moves by about its size or twice that,
# so what is much smaller does not carry the swing
CARRIES = 0.2
SINE = 0.1  # below 0.5: He's published limit of a sine
SILENT = Oscillation(np.nan, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Features:
    """Likelihood and indices of one record; an index that does not apply is 0.

    Those of the form of the wave do not apply to a commanded swing: it has the form of the command.

    Attributes
    ----------
    memory : float
        Of a valve that sticks: log(1 + gain / 3) of backlash or stiction, the larger one, whether or not it was chosen
        (a gain that something set aside still speaks). The gain is the firm one in log-likelihood over the linear
        model, less what its parameters cost, 3 being the least that counts.
    shape : float
        He's index minus 0.5: triangle above 0, sine below. The larger one of OP (where the triangle is in a
        self-regulating loop) and PV (where it is in a level loop): routine records tell these two badly apart.
    waveform : float
        Log-odds of the waveform index, within -4 and 4.
    dead_zone, saturation : float
        Of the other faults: log(1 + gain) where the likelihood chose that kind and what it leaves over is white: where
        the model does not fit, its gain is no evidence of a fault. A dead zone that the record does not show whole is
        none either.
    sine : float
        The negative part of `shape`, down to -0.1, He's limit of a sine: what swings so is moved from outside or badly
        tuned.
    """

    memory: float = 0.0
    shape: float = 0.0
    waveform: float = 0.0
    dead_zone: float = 0.0
    saturation: float = 0.0
    sine: float = 0.0

    def values(self) -> FloatArray:
        """All in order."""
        return np.array([getattr(self, field.name) for field in fields(self)])


@dataclass(frozen=True)
class Measured:
    """Features, and what a reader may want to see of them.

    Attributes
    ----------
    features : Features
    op, pv : Oscillation
        Of each signal; period NaN where too short.
    period : float
        Of the loop in samples, NaN where nothing swings.
    integrating : bool
        Whether the process was taken as integrating.
    indices : dict of float
        Every index that could be computed, by name.
    driven : bool
        Whether the swing comes from outside: SP swings so, or the fault that was found needs one of its period beside
        it.
    commanded : bool
        Whether SP swings so, and that is all of the swing: PV follows it.
    negligible : bool
        Whether the lost motion that fits best is one that a sound valve has, and too small to make OP swing as it does.
        Its gain is no evidence then.
    """

    features: Features
    op: Oscillation
    pv: Oscillation
    period: float
    integrating: bool
    indices: dict[str, float]
    driven: bool = False
    commanded: bool = False
    negligible: bool = False

    @property
    def swings(self) -> bool:
        """Whether OP or PV swings regularly, and that is most of what it does."""
        return bool(np.isfinite(self.period))


def measure(
    fit: HammersteinFit, integrating: bool | None = None, sp: FloatArray | None = None, sound: float = 0.0
) -> Measured:
    """Measure everything on the longest piece of what was identified.

    Parameters
    ----------
    fit : HammersteinFit
        With nonlinearity="auto".
    integrating : bool, optional
        Whether the process integrates (a level); None: as identified.
    sp : ndarray, optional
        Set point on the rows of the data.
    sound : float
        Lost motion that a sound valve has, in units of OP.
    """
    data = fit.data
    start, stop = max(data.segments.tolist(), key=lambda pair: pair[1] - pair[0])
    rows = slice(start, min(stop, start + MOST_ROWS))
    op, pv = data.u[rows], data.y[rows]
    levels = fit.chosen.integrating if integrating is None else integrating
    of_op, of_pv = _oscillation(op), _oscillation(pv)
    swinging = [one for one in (of_op, of_pv) if _swings(one)]
    period = max(swinging, key=lambda one: one.regularity).period if swinging else np.nan
    indices = _indices(op, pv, period) if swinging and period >= SHORTEST_PERIOD else {}
    command, followed = (0.0, 0.0) if sp is None else _command(sp[rows], pv, float(period))
    driven = _driven(fit, float(period)) or command > COMMANDED
    commanded = command > COMMANDED and followed > FOLLOWED
    shape = max(indices.get("shape_op", 0.5), indices.get("shape_pv", 0.5)) - 0.5
    indices |= _waveform(op, pv, levels)
    odds = float(np.clip(indices.get("waveform", 0.0), -MOST_ODDS, MOST_ODDS))
    if commanded:  # PV has the form of the command, whatever the valve does
        shape = odds = 0.0
    negligible = _is_negligible(fit, sound, swing_of(of_op, float(np.std(op))) if swinging else 0.0)
    gains = {} if negligible else _gains(fit)
    features = Features(**gains, shape=shape, waveform=odds, sine=float(np.clip(shape, -SINE, 0.0)))
    return Measured(features, of_op, of_pv, float(period), levels, indices, driven, commanded, negligible)


def swing_of(found: Oscillation, deviation: float) -> float:
    """Swing of a signal from end to end, from its deviation and the share that swings."""
    return 2.0 * deviation * float(np.sqrt(2.0 * max(found.share, 0.0)))


def swing_of_rows(data: IdentificationData) -> float:
    """Swing of OP from end to end in the longest piece, where it swings regularly; else 0."""
    start, stop = max(data.segments.tolist(), key=lambda pair: pair[1] - pair[0])
    op = data.u[start : min(stop, start + MOST_ROWS)]
    found = _oscillation(op)
    return swing_of(found, float(np.std(op))) if _swings(found) else 0.0


def _swings(found: Oscillation) -> bool:
    """Whether it is regular, and most of what the signal does."""
    return found.regular and found.share > LEAST_SHARE and found.cycles > FEWEST_CYCLES


def is_negligible(largest: float, sound: float, swing: float) -> bool:
    """Whether a lost motion of at most this size is below what a sound valve has and what would carry the swing."""
    return largest < sound and (swing == 0.0 or largest < CARRIES * swing)


def _is_negligible(fit: HammersteinFit, sound: float, swing: float) -> bool:
    return fit.kind.size is not None and is_negligible(largest_known(fit), sound, swing)


def _driven(fit: HammersteinFit, period: float) -> bool:
    """Whether a fault was found with a swing of this period beside it."""
    own = fit.kind.name != NO_FAULT
    return own and any(abs(swing / period - 1.0) < SAME for swing in fit.chosen.periods)


def _command(sp: FloatArray, pv: FloatArray, period: float) -> tuple[float, float]:
    """Amplitude of SP over that of PV near a period, and their coherence there; 0 where nothing swings."""
    if not np.isfinite(period):
        return 0.0, 0.0
    cycles = np.arange(sp.size // 2 + 1) * (period / sp.size)
    near = np.abs(cycles - 1.0) <= BAND
    window = np.hanning(sp.size)
    command, answer = (np.fft.rfft((x - x.mean()) * window)[near] for x in (sp, pv))
    large, small = float(np.linalg.norm(answer)), float(np.linalg.norm(command))
    if small == 0.0 or large == 0.0:
        return 0.0, 0.0
    return small / large, float(abs(np.vdot(command, answer))) / (small * large)


def _gains(fit: HammersteinFit) -> dict[str, float]:
    """Of each class of evidence."""
    found: dict[str, float] = {}
    firm = fit.kinds.firm if fit.kinds is not None else {}
    for kind in faults():
        gain = max(firm.get(kind.name, 0.0), 0.0)
        if kind.sticks:
            found[kind.evidence] = max(found.get(kind.evidence, 0.0), float(np.log1p(gain / NEEDED)))
        elif fit.kind is kind and fit.status not in DOUBTFUL and not not_shown(fit):
            found[kind.evidence] = float(np.log1p(gain))
    return found


def _oscillation(x: FloatArray) -> Oscillation:
    try:
        return find_oscillation(x)
    except DataError:  # too short, or it does not move
        return SILENT


def _indices(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    """Indices that need a period; one that cannot be computed is left out."""
    found: dict[str, float] = {}

    def add(measurement: dict[str, float]) -> None:
        found.update({name: value for name, value in measurement.items() if np.isfinite(value)})

    for work in (_shapes, _lopsided, _correlation, _relay, _ellipse, _bicoherence):
        try:
            add(work(op, pv, period))
        except DataError:  # too few cycles for this one
            continue
    return found


def _waveform(op: FloatArray, pv: FloatArray, integrating: bool) -> dict[str, float]:
    try:
        return {"waveform": waveform_index(op, pv, integrating).log_odds}
    except DataError:  # too short
        return {}


def _shapes(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    return {"shape_op": shape_index(op, period).index, "shape_pv": shape_index(pv, period).index}


def _lopsided(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    del pv
    return {"lopsided_op": lopsided_index(op, period)}


def _correlation(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    return {"horch": cross_correlation_index(op, pv, period).delta_tau}


def _relay(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    del op
    return {"relay": relay_index(pv, period).index}


def _ellipse(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    found = apparent_stiction(op, pv, period)
    return {"ellipse_width": found.width, "ellipse_share": found.share}


def _bicoherence(op: FloatArray, pv: FloatArray, period: float) -> dict[str, float]:
    del op
    found = bicoherence_indices(pv, period)
    return {"ngi": found.ngi, "nli": found.nli}
