"""Stiction of a valve."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any, ClassVar, Self

import numpy.typing as npt

from lostmotion.arguments import along_time, finite, not_negative, positive
from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as numbers
from lostmotion.kernels import stiction as kernel
from lostmotion.models.fundamentals import gliding_sine
from lostmotion.models.kernel_view import padded
from lostmotion.models.registry import actuator

CODES = {"choudhury": kernel.CHOUDHURY, "kano": kernel.KANO, "he": kernel.HE, "he ramp": kernel.HE_RAMP}


@actuator
@dataclass(frozen=True)
class Stiction:
    """Valve that sticks, then slips: three published models, and one of them between samples, on two parameters.

    It rests until u has gone far enough, jumps, and moves with ``x = u - d (band - jump) / 2``, d = direction.
    ``jump < band`` undershoots, ``jump == band`` is pure stick-slip, ``jump > band`` overshoots, ``jump == 0`` is
    a dead band (:class:`Backlash`). Every call starts at rest, x = u at the first sample, in the middle of the
    band: the first break-away comes at ``abs(u - x) > (band + jump) / 2``. :meth:`run` takes another start.

    Parameters
    ----------
    band : float
        Dead band plus stick band S of Choudhury: the full travel of u, in units of u, between a reversal and the
        move that follows. Not negative.
    jump : float
        Slip jump J in units of u, not negative.
    model : {"kano", "choudhury", "he", "he ramp"}
        - ``"choudhury"`` (2005): counts S from the last turn of u and J from a hold. Small reversals inside the
          band start the count again, so under noise the valve may never move.
        - ``"kano"`` (2004): remembers u where the valve stopped, so that ``abs(u - x) <= (band + jump) / 2`` for
          every u.
        - ``"he"`` (2007): static friction ``(band + jump) / 2`` and dynamic friction ``(band - jump) / 2``; comes
          to rest after every sample and so follows a ramp in steps of `jump`.
        - ``"he ramp"``: the same where u goes in a straight line from sample to sample, as it arrives at a valve
          behind an actuator: the valve breaks away between samples, every slip is `jump` long, and x is the mean
          position over the sample.

    Raises
    ------
    ParameterError
        A negative or infinite number, or an unknown model.

    Notes
    -----
    Sources and readings of the texts: :mod:`lostmotion.kernels.stiction`.

    Examples
    --------
    >>> u = [0.0, 2.0, 3.0, 4.0, 3.0, 1.0, -1.0]
    >>> Stiction(band=4.0, jump=1.0)(u).tolist()
    [0.0, 0.0, 1.5, 2.5, 2.5, 2.5, 0.5]
    >>> Stiction(band=4.0, jump=1.0, model="he")(u).tolist()
    [0.0, 0.0, 1.5, 1.5, 1.5, 1.5, 1.5]
    """

    band: float
    jump: float
    model: str = "kano"

    kind: ClassVar[str] = "stiction"
    own: ClassVar[tuple[str, ...]] = ("band", "jump")
    size_name: ClassVar[str | None] = "band"

    def __post_init__(self) -> None:
        for name in ("band", "jump"):
            object.__setattr__(self, name, not_negative(name, getattr(self, name)))
        if not isinstance(self.model, str) or self.model not in CODES:
            raise ParameterError.expected(f"model out of {sorted(CODES)}", repr(self.model), "choose one of them")

    @property
    def code(self) -> int:
        """Number of the model in the kernels."""
        return CODES[self.model]

    def __call__(self, u: npt.ArrayLike) -> float | FloatArray:
        """Position x for u, a scalar or shape (n,), from rest at the first finite sample; NaN gives NaN."""
        return self.run(u)

    def run(self, u: npt.ArrayLike, start: float | None = None) -> float | FloatArray:
        """Position x for u, a scalar or shape (n,), from rest at `start` (None: x = u at the first sample)."""
        before = math.nan if start is None else finite("start", start)
        return along_time(lambda array: kernel.run(self.code, array, self.band, self.jump, before), u)

    def describing_function(self, amplitude: float) -> complex:
        """Gain of the fundamental for ``amplitude * sin(t)``, complex; 0 where the sine is too small to move it.

        Choudhury et al. (2005), section on the describing function. The models "choudhury" and "kano" answer alike
        to a sine that keeps them moving; where ``amplitude < (band + jump) / 2`` Kano's valve must be in motion
        already, from rest it stays at rest.

        Raises
        ------
        ParameterError
            Models "he" and "he ramp", which move in steps that depend on the sampling: use
            :func:`~lostmotion.models.describing_function`.
        """
        size = positive("amplitude", amplitude)
        if self.model in ("he", "he ramp"):
            raise ParameterError.expected("model 'choudhury' or 'kano'", repr(self.model), "use describing_function()")
        return gliding_sine(self.band / size, self.jump / size)

    @property
    def kernel_code(self) -> int:
        """Number in ``kernels.actuator``."""
        return numbers.STICTION + self.code

    def kernel_parameters(self) -> FloatArray:
        """Parameters in the order of ``kernels.actuator``, shape (5,)."""
        return padded(self.band, self.jump)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""
        return {"kind": self.kind, **asdict(self)}

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Inverse of :meth:`to_dict`."""
        names = ("band", "jump")
        if any(name not in data for name in names):
            raise ParameterError.expected(f"keys {list(names)}", sorted(data), "use to_dict()")
        return cls(data["band"], data["jump"], data.get("model", "kano"))
