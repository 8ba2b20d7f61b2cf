"""Simulate a loop of controller, compensator, actuator and process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.compensate import DeadZoneCompensator
from lostmotion.errors import ParameterError
from lostmotion.kernels import actuator as kernel
from lostmotion.kernels.loop import closed_loop
from lostmotion.models import (
    Backlash,
    DeadZone,
    DeadZoneInverse,
    Hammerstein,
    Identity,
    LinearModel,
    Saturation,
    Stiction,
)
from lostmotion.models._arguments import FloatArray, finite_signal
from lostmotion.simulate.controllers import PI

_OPEN = np.zeros(5)


@dataclass(frozen=True, eq=False)
class LoopResponse:
    """Signals of a simulated loop, each of shape (n,).

    Attributes
    ----------
    time : seconds
    reference, output, measured : set point, true output, output with noise
    control, command, internal : controller output, command behind the compensator, internal variable x
    """

    time: FloatArray
    reference: FloatArray
    output: FloatArray
    measured: FloatArray
    control: FloatArray
    command: FloatArray
    internal: FloatArray
    dt: float

    def __len__(self) -> int:
        return len(self.time)

    def indices(self, start: float = 0.0, stop: float | None = None) -> dict[str, float]:
        """Control variance eps1, mean absolute error eps2 (paper, eqs 32-33), travel and reversals of a track.

        Parameters
        ----------
        start, stop : float
            Track in seconds; default all.
        """
        result: dict[str, float] = _verbs.indices(self, start=start, stop=stop)
        return result

    def plot(self, **options: Any) -> Any:
        """Figure of level and control (needs the extra ``lostmotion[plot]``)."""
        return _verbs.plot(self, **options)


def simulate_loop(
    plant: Hammerstein | LinearModel,
    controller: PI,
    reference: npt.ArrayLike,
    dt: float | None = None,
    compensator: DeadZoneCompensator | DeadZoneInverse | None = None,
    disturbance: npt.ArrayLike | None = None,
    noise: float | npt.ArrayLike | None = None,
    seed: int | np.random.Generator | None = None,
    *,
    disturbance_path: LinearModel | None = None,
    allow_unstable: bool = False,
) -> LoopResponse:
    """Simulate a closed loop from rest.

    Parameters
    ----------
    plant : Hammerstein or LinearModel
        Process with its actuator; delay at least 1 sample.
    controller : PI
        Controller; it sees the measured output.
    reference : array_like, shape (n,)
        Set point in units of y.
    dt : float, optional
        Sampling time in seconds; None: the plant's.
    compensator : DeadZoneCompensator or DeadZoneInverse, optional
        Between controller and actuator.
    disturbance : array_like, shape (n,), optional
        Added to the output, behind `disturbance_path` where one is given.
    noise : float or array_like, optional
        Variance of white measurement noise in units of y squared, or its samples.
    seed : int or Generator, optional
        Seed of the noise.
    disturbance_path : LinearModel, optional
        Dynamics between disturbance and output.
    allow_unstable : bool
        Simulate unstable and integrating plants too.

    Raises
    ------
    ParameterError
        Unstable plant, delay 0, dt that contradicts the plant's, an actuator without a loop kernel.
    DataError
        Signals of different length.

    Examples
    --------
    >>> from lostmotion.models import LinearModel
    >>> loop = simulate_loop(LinearModel([-0.9], [0.1], 1, 0.1), PI(2.0, 5.0), [1.0] * 200)
    >>> round(float(loop.output[-1]), 3)
    1.0
    """
    model = plant if isinstance(plant, Hammerstein) else Hammerstein(Identity(), plant)
    linear = model.linear
    dt = linear.dt if dt is None else dt
    if not abs(dt - linear.dt) <= 1e-9 * linear.dt:
        raise ParameterError.expected(f"dt={linear.dt} as the plant's", dt, "resample the plant or leave dt out")
    if linear.delay < 1:
        raise ParameterError.expected("delay >= 1 in a loop", linear.delay, "a held input acts one sample later")
    if not linear.is_stable and not allow_unstable:
        remedy = "its poles must lie inside the unit circle; allow_unstable=True simulates it all the same"
        raise ParameterError.expected("a stable plant", f"poles {linear.poles.round(4).tolist()}", remedy)
    r = finite_signal("reference", reference)
    added = np.zeros(r.size) if disturbance is None else finite_signal("disturbance", disturbance, r.size)
    if disturbance_path is not None:
        added = disturbance_path.simulate(added)
    kind, parameters = _actuator(model)
    inverse, has_inverse = _inverse(compensator)
    control, command, x, clean, measured = closed_loop(
        np.array(linear.a), np.array(linear.b), linear.delay, model.offset, parameters, inverse, kind, has_inverse,
        controller.kp, controller.ki * dt, controller.low, controller.high, controller.bias, r, added,
        _noise(noise, r.size, seed),
    )  # fmt: skip
    return LoopResponse(np.arange(r.size, dtype=np.float64) * dt, r, clean, measured, control, command, x, dt)


def _noise(noise: float | npt.ArrayLike | None, n: int, seed: int | np.random.Generator | None) -> FloatArray:
    if noise is None:
        return np.zeros(n)
    if np.ndim(noise) > 0:
        return finite_signal("noise", noise, n)
    variance = float(np.asarray(noise))
    if not (np.isfinite(variance) and variance >= 0):
        raise ParameterError.expected("noise variance >= 0", variance, "give a variance or the samples")
    return np.random.default_rng(seed).normal(scale=np.sqrt(variance), size=n)


def _actuator(model: Hammerstein) -> tuple[int, FloatArray]:
    """Number and parameters of the actuator, as ``kernels.actuator`` knows it."""
    valve = model.nonlinearity
    parameters = np.zeros(5)
    if isinstance(valve, Identity):
        return kernel.NONE, parameters
    if isinstance(valve, DeadZone):
        parameters[:4] = valve.left, valve.right, valve.left_slope, valve.right_slope
        return kernel.DEAD_ZONE, parameters
    if isinstance(valve, Backlash):
        parameters[0] = valve.width
        return kernel.BACKLASH, parameters
    if isinstance(valve, Saturation):
        parameters[:2] = valve.low, valve.high
        return kernel.SATURATION, parameters
    if isinstance(valve, Stiction):
        parameters[:2] = valve.band, valve.jump
        return kernel.STICTION + valve.code, parameters
    raise ParameterError.expected(
        "a DeadZone, Backlash, Stiction, Saturation or Identity", type(valve).__name__, "see lostmotion.models"
    )


def _inverse(compensator: DeadZoneCompensator | DeadZoneInverse | None) -> tuple[FloatArray, bool]:
    if compensator is None:
        return _OPEN, False
    if isinstance(compensator, DeadZoneInverse):
        compensator = DeadZoneCompensator(compensator.dead_zone)
    return compensator.kernel_parameters(), True
