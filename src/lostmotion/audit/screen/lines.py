"""Lines of the error of control, band by band, in two bytes each: by them two loops are told to share a swing.

A spectrum has powers only, and loops that share nothing often have like powers; whether they move together is in the
phases.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scipy.fft

from lostmotion.arrays import ComplexArray, FloatArray
from lostmotion.diagnose.control_error.spectrum import LEAST_ROWS, Spectrum

WIDTH = 4.0  # highest over lowest frequency of a band; the next begins an octave higher, so a swing lies inside of one
MOST = 256  # lines of a band: 85 periods of its slowest and 341 of its fastest, from the start of the window
LEAST_SHARE = 0.02  # of the power, in a band that is kept
SLOWEST = 2.0  # periods in the window
ROWS = 8.0  # in the fastest period of a band, after thinning
TAPER = 0.5  # of the time rises and falls: the jump from end to start would be in all drifting loops alike
GAPS = 8  # times the rows: how long a record with gaps is looked at
HEAD = struct.Struct("<hHHd")  # octave, number of lines, number of the first, seconds
STEP, QUIET = 0.05, 255  # magnitudes are kept as logarithms in steps of 5 %, down to 3e-6 of the largest
TURN = 256  # steps of a phase


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines of one band.

    Attributes
    ----------
    seconds : float
        From the start of the window; line k is at k / seconds (Hz).
    first : int
        k of the first line.
    values : ndarray of complex, shape (m,)
        The largest is 1 in magnitude.
    """

    seconds: float
    first: int
    values: ComplexArray


def taper(size: int) -> FloatArray:
    """Weights that rise and fall as a cosine at both ends (Tukey), shape (n,); those of SciPy take a heavy import."""
    place = np.arange(size) / max(size - 1, 1)
    rest = np.minimum(np.minimum(place, 1.0 - place) * 2.0 / TAPER, 1.0)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * rest))


def octave_of(frequency: float) -> int:
    """Number of the band that begins at a frequency (Hz), or less than an octave below."""
    return int(np.floor(np.log2(frequency)))


def lines_of(error: FloatArray, times: FloatArray, dt: float, spectrum: Spectrum) -> bytes:
    """Lines of all bands that have power.

    Parameters
    ----------
    error : ndarray, shape (n,)
        Error of control, NaN in rows that do not count.
    times : ndarray, shape (n,)
        Seconds from the start of the window to each row.
    dt : float
        Seconds between rows.
    spectrum : Spectrum
        Of the same error.

    Returns
    -------
    bytes
        As :func:`bands_in` reads them; empty where too little is known.
    """
    row = np.floor(times / dt + 0.5).astype(np.int64)
    known = np.isfinite(error) & (row >= 0) & (row < GAPS * error.size)
    if int(known.sum()) < LEAST_ROWS:
        return b""
    size = int(row[known].max()) + 1
    total, count = np.zeros(size), np.zeros(size)
    total[row[known]], count[row[known]] = error[known], 1.0
    seconds = min(float(times[-1]) + dt, GAPS * error.size * dt)
    found, step = [], dt
    for octave in range(octave_of(0.25 / dt), octave_of(SLOWEST / seconds) - 1, -1):
        low = 2.0**octave
        while 2.0 * step * ROWS * WIDTH * low <= 1.0 and total.size > LEAST_ROWS:
            total, count, step = _halved(total), _halved(count), 2.0 * step
        if float(np.diff(spectrum.below(np.array([low, WIDTH * low])))[0]) >= LEAST_SHARE:
            found.append(_band(octave, total, count, step, min(seconds, MOST / ((WIDTH - 1.0) * low))))
    return b"".join(found)


def _halved(values: FloatArray) -> FloatArray:
    """Sums of two."""
    return np.asarray(np.pad(values, (0, values.size % 2)).reshape(-1, 2).sum(axis=1))


def _band(octave: int, total: FloatArray, count: FloatArray, step: float, seconds: float) -> bytes:
    """One band of the first so many seconds; empty where nothing is known in them."""
    size = max(round(seconds / step), 1)
    total, count = (np.pad(one[:size], (0, max(size - one.size, 0))) for one in (total, count))
    if not count.any():
        return b""
    values = np.where(count > 0.0, total / np.maximum(count, 1.0) - total.sum() / count.sum(), 0.0)
    lines = scipy.fft.rfft(values / max(float(np.abs(values).max()), 1e-300) * taper(size))
    low = 2.0**octave * size * step
    first, last = max(int(np.ceil(low)), 1), min(int(WIDTH * low), lines.size - 1)
    chosen = lines[first : last + 1]
    if not chosen.any():
        return b""
    magnitude = np.abs(chosen) / float(np.abs(chosen).max())
    loudness = np.minimum(np.round(-np.log(np.maximum(magnitude, 1e-300)) / STEP), QUIET)
    turns = np.round(np.angle(chosen) / (2.0 * np.pi) * TURN) % TURN
    packed = np.stack([loudness, turns]).astype(np.uint8)
    return HEAD.pack(octave, chosen.size, first, size * step) + packed.tobytes()


def bands_in(kept: bytes) -> dict[int, Lines]:
    """What :func:`lines_of` has made, by octave."""
    return dict(_bands(kept))


def _bands(kept: bytes) -> Iterator[tuple[int, Lines]]:
    place = 0
    while place < len(kept):
        octave, size, first, seconds = HEAD.unpack_from(kept, place)
        packed = np.frombuffer(kept, np.uint8, 2 * size, place + HEAD.size).astype(np.float64)
        magnitude = np.where(packed[:size] < QUIET, np.exp(-STEP * packed[:size]), 0.0)
        yield octave, Lines(seconds, first, magnitude * np.exp(2j * np.pi / TURN * packed[size:]))
        place += HEAD.size + 2 * size
