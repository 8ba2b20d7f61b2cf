"""RecursiveML: recursive maximum likelihood of the whole Hammerstein model, started from a batch fit."""

from __future__ import annotations

import math
from typing import Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import signal, whole
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError
from lostmotion.identify.recursive import ml_report
from lostmotion.identify.recursive.ml_bytes import packed, unpacked
from lostmotion.identify.recursive.ml_recursion import Recursion
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.identify.recursive.ml_start import FirstWindow
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent, RecursiveEstimate, Trajectory


class RecursiveML:
    """Recursive maximum likelihood (prediction error) of dead zone, process, offset and AR noise.

    A first window is fitted in batch. After it every sample adds its linearised equation to an information matrix,
    and the estimate is the solution of all that is remembered: as accurate as the batch fit of all samples, at the
    cost of a few filters per sample. A change of a break point raises an event, and what it made wrong is forgotten.

    Parameters
    ----------
    na, nb, delay : int
        Orders and delay of the linear part, as in ``identify``.
    gain : float or None
        Known static gain of the linear part (paper, eq 25). None: right_slope = 1.
    forgetting : float
        In (0.95, 1]. The memory is 1 / (1 - forgetting) samples. It is forgotten only as fast as new information
        comes in, direction by direction, so without excitation nothing is lost.
    dt : float
        Sampling time in seconds, for the linear model.
    noise : "auto", "white" or int
        Order of the AR output noise; "auto": as the batch fit of the first window finds it.
    offset : {"auto", "free", "zero"}
        Output at rest inside the dead zone, as in ``identify``. It is always estimated; "auto" reports the estimate
        with offset zero while the information criterion prefers it.
    start_samples : int
        Samples of the first window. Where it tells little, or OP stood at fewer than ten values in it, twice,
        four and eight times as many are tried.
    outliers : float or None
        Prediction errors beyond so many standard deviations have bounded influence (Huber); None: they count fully.
    false_alarms : float or None
        Accepted false events per sample; None: no test for changes.

    Notes
    -----
    Missing samples are NaN; they, masked samples (``use=False``) and the time that the process needs to forget an
    unknown command after them add no information. A PV that is to the last bit the one before, more often in a row than
    chance allows (share of PV that come again, to the power of the times, below 1e-4), is taken for missing; where more
    than one in ten comes again, since it is rounded, no repeat tells anything. Where it is rounded to more than 1.5
    deviations of the errors of a first window in which OP rests, the ninth and further equal samples in a row count
    little, being one error of rounding, and noise="auto" is white. The state does not grow; results do not depend on
    how the stream is cut. Method: Ljung and Soderstrom, *Theory and Practice of Recursive Identification* (1983),
    sections 3.7 and 5; test: Basseville and Nikiforov, *Detection of Abrupt Changes* (1993), chapter 8.

    Integrating processes are not followed: a window whose batch fit is integrating does not start the recursion, and
    the status says so (INTEGRATING). The differences of PV, with `na` one less, are followed.

    Break points may drift. Six hypotheses are kept of how far they walk in 10,000 informative samples, from not at all
    to 0.3 standard deviations of u; the newest 1,000 samples (half the memory, where it is shorter) count alike, older
    ones as much as the likeliest hypothesis leaves of them, and the standard errors hold the walk. Where the process,
    too, changes slowly, forget.

    Prediction errors are watched. Correlations above 0.15 at one of eight lags up to 16 samples give COLOURED: too low
    an order of the noise, or another process. Tests for changes are divided by how much their statistics vary anyhow.

    Where all moves of OP are multiples of a step, it is taken to be rounded: the standard errors of the break points
    hold the step / sqrt(12), since between two levels a break point may be anywhere.

    Commands further than ten times the range so far beyond it are taken for missing, for one block of samples (64 at
    most), further than a thousand times for ever.

    A width is claimed (Status.OK) where BIC prefers it to none, not from 1.96 standard errors on: the estimate is
    looked at again and again.

    Standard errors take the remembered information at full weight. With forgetting below 1 they are therefore wider
    than the noise alone would ask for (by up to the square root of two), which leaves room for the drift for whose
    sake one forgets.

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> u = lm.signals.prs(20_000, -5, 5, hold=10, seed=0)
    >>> y = tank.simulate(u) + np.random.default_rng(0).normal(scale=0.03**0.5, size=u.size)
    >>> rml = lm.RecursiveML(na=3, nb=2, delay=3, gain=2.2222)
    >>> trajectory = rml.run(u, y)
    >>> abs(rml.estimate.parameters["right"] - 1.0) < 0.005
    True
    """

    def __init__(
        self,
        na: int,
        nb: int,
        delay: int,
        gain: float | None = None,
        forgetting: float = 1.0,
        *,
        dt: float = 1.0,
        noise: str | int = "auto",
        offset: str = "auto",
        start_samples: int = 1000,
        outliers: float | None = 4.0,
        false_alarms: float | None = 1e-9,
    ) -> None:
        self._begin(
            Settings(
                na=na,
                nb=nb,
                delay=delay,
                gain=gain,
                forgetting=forgetting,
                dt=dt,
                noise=noise,
                offset=offset,
                start_samples=start_samples,
                outliers=outliers,
                false_alarms=false_alarms,
            )
        )

    def _begin(self, settings: Settings) -> None:
        self._first = FirstWindow(settings)
        self._recursion: Recursion | None = None

    @property
    def _settings(self) -> Settings:
        return self._first.settings

    @property
    def samples(self) -> int:
        """Samples seen, missing ones included."""
        return self._first.seen if self._recursion is None else self._recursion.samples

    @property
    def started(self) -> bool:
        """Whether the first window has been fitted."""
        return self._recursion is not None

    @property
    def start_samples(self) -> int:
        """Samples of the first window."""
        return self._settings.start_samples

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""
        return self._settings.dt

    @property
    def events(self) -> tuple[ChangeEvent, ...]:
        """The last changes, oldest first, 100 at most."""
        return () if self._recursion is None else tuple(self._recursion.events)

    def update(self, u: float, y: float, use: bool = True) -> float:
        """Take one sample; return its prediction error, NaN where there is none.

        Parameters
        ----------
        u, y : float
            Command and measurement; NaN: missing.
        use : bool
            False where the sample must not be learned from: manual mode with an unknown command, saturation.

        Raises
        ------
        DataError
            u or y is infinite or no number; nothing has changed then.
        """
        try:
            u, y = float(u), float(y)
        except (TypeError, ValueError, OverflowError) as broken:
            raise DataError.expected(
                "numbers u and y", f"u={u!r}, y={y!r}", "give NaN for a missing sample"
            ) from broken
        if math.isinf(u) or math.isinf(y):
            raise DataError.expected("finite u and y", f"u={u}, y={y}", "give NaN for a missing sample")
        if self._recursion is not None:
            return self._recursion.update(u, y, bool(use))
        self._recursion = self._first.take(u, y, use)
        return math.nan

    def run(self, u: npt.ArrayLike, y: npt.ArrayLike, every: int = 1, use: npt.ArrayLike | None = None) -> Trajectory:
        """Take all samples; keep every `every`-th estimate.

        Parameters
        ----------
        u, y : array_like, shape (n,)
            Command and measurement; NaN: missing.
        every : int
            Distance of the rows of the trajectory.
        use : array_like of bool, shape (n,), optional
            False where a sample must not be learned from.
        """
        u, y, mask = _checked(u, y, use)
        every = min(whole("every", every, 1), u.size + 1)
        samples = self.samples + every * np.arange(1, u.size // every + 1)
        errors, rows = np.full(u.size, np.nan), np.empty((0, 0))
        at = 0
        while at < u.size and self._recursion is None:
            self._recursion = self._first.take(float(u[at]), float(y[at]), bool(mask[at]))
            at += 1
        if self._recursion is not None:
            rows, errors[at:] = self._recursion.run(u, y, mask, at, every)
        return ml_report.trajectory(self._settings, self._recursion, samples, rows, errors)

    def reset(self, names: tuple[str, ...] = ("left", "right")) -> None:
        """Forget what is known about some parameters, as after a repair; the rest is kept.

        Parameters
        ----------
        names : tuple of str
            "left", "right", "slope_ratio", "process" (a, b and offset), "noise".
        """
        if self._recursion is None:
            self._begin(self._settings)
        else:
            self._recursion.forget(names)

    @property
    def estimate(self) -> RecursiveEstimate:
        """Present estimate with standard errors; CANNOT_TELL while the first window fills."""
        if self._recursion is None:
            return ml_report.nothing_yet(self._settings, self.samples, self._first.integrating)
        return ml_report.present(self._recursion)

    def period(self) -> tuple[dict[str, float], dict[str, float], int] | None:
        """Break points and width from the samples since the last call alone, for trends; begins a new period.

        Returns
        -------
        (values, standard errors, samples) or None
            From these samples alone: all other parameters are estimated anew with them, since what is known of them
            from before would make the periods depend on each other and their errors look too small. None: a break
            point is not known to a quarter of the range of u.
        """
        return None if self._recursion is None else ml_report.end_period(self._recursion)

    def to_bytes(self) -> bytes:
        """Whole state; :meth:`from_bytes` continues bit by bit where this one stands."""
        return packed(self._first, self._recursion)

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Estimator from the bytes of :meth:`to_bytes`.

        Raises
        ------
        DataError
            The bytes are something else.
        """
        first, recursion = unpacked(data)
        new = cls.__new__(cls)
        new._first, new._recursion = first, recursion
        return new


def _checked(
    u: npt.ArrayLike, y: npt.ArrayLike, use: npt.ArrayLike | None
) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_]]:
    u, y = signal("u", u), signal("y", y)
    try:
        mask = np.ones(u.size, dtype=bool) if use is None else np.array(use, dtype=bool, order="C")
    except ValueError as broken:
        raise DataError.expected("use as one bool a sample", repr(use)[:60], "make it an array") from broken
    if not u.shape == y.shape == mask.shape:
        raise DataError.expected(
            "u, y and use of one length", f"{u.shape}, {y.shape} and {mask.shape}", "cut them to the same rows"
        )
    for name, values in (("u", u), ("y", y)):
        if np.isinf(values).any():
            row = int(np.flatnonzero(np.isinf(values))[0])
            raise DataError.expected(f"finite {name}", f"{values[row]} in row {row}", "give NaN for a missing sample")
    return u, y, mask
