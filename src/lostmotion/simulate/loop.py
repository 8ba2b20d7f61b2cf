"""Simulate a loop of controller, compensator, actuator and process."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite_signal
from lostmotion.arrays import FloatArray
from lostmotion.compensate import BacklashCompensator, CompensatorBlock, DeadZoneCompensator
from lostmotion.compensate.block import MOST_SETTING
from lostmotion.errors import ParameterError
from lostmotion.kernels.loop import closed_loop
from lostmotion.models import BacklashInverse, DeadZoneInverse, Hammerstein, Identity, LinearModel
from lostmotion.simulate.block_loop import BlockLoop, actuator_code
from lostmotion.simulate.controllers import PI
from lostmotion.simulate.response import LoopResponse

_OPEN = np.zeros(5)
_WIDE = {"low": -MOST_SETTING, "high": MOST_SETTING, "cap": MOST_SETTING, "rate": MOST_SETTING}  # no safeguards

Compensator = DeadZoneCompensator | DeadZoneInverse | BacklashCompensator | BacklashInverse | CompensatorBlock


def simulate_loop(
    plant: Hammerstein | LinearModel,
    controller: PI,
    reference: npt.ArrayLike,
    dt: float | None = None,
    compensator: Compensator | None = None,
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
    compensator : CompensatorBlock, DeadZoneCompensator, BacklashCompensator or an inverse, optional
        Between controller and actuator. A block starts with its first scan, enabled; where it cuts the command, the
        integral of the controller stops, as with its output BACK wired to the controller's anti-windup.
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
        Unstable plant, delay 0, dt that contradicts the plant's, an actuator without a loop kernel, a block with
        another scan time.
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
        remedy = "its poles must lie inside the unit circle, or simulate it all the same: allow_unstable=True"
        raise ParameterError.expected("a stable plant", f"poles {linear.poles.round(4).tolist()}", remedy)
    r = finite_signal("reference", reference)
    added = np.zeros(r.size) if disturbance is None else finite_signal("disturbance", disturbance, r.size)
    if disturbance_path is not None:
        added = disturbance_path.simulate(added)
    if isinstance(compensator, BacklashCompensator | BacklashInverse | CompensatorBlock):
        loop = BlockLoop(model, controller, r, added, _noise(noise, r.size, seed), _block(compensator, dt))
        loop.advance(r.size)
        return loop.response
    kind, parameters = actuator_code(model.nonlinearity)
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


def _inverse(compensator: DeadZoneCompensator | DeadZoneInverse | None) -> tuple[FloatArray, bool]:
    if compensator is None:
        return _OPEN, False
    if isinstance(compensator, DeadZoneInverse):
        compensator = DeadZoneCompensator(compensator.dead_zone)
    return compensator.kernel_parameters(), True


def _block(compensator: BacklashCompensator | BacklashInverse | CompensatorBlock, dt: float) -> CompensatorBlock:
    """The block, or the ideal inverse as a block without safeguards."""
    if not isinstance(compensator, CompensatorBlock):
        lead = 0.5 * compensator.backlash.width
        return CompensatorBlock.of("backlash", dt, {**_WIDE, "lead_up": lead, "lead_down": lead})
    if not abs(compensator.scan_time - dt) <= 1e-9 * dt:
        raise ParameterError.expected(f"a block with scan_time={dt}", compensator.scan_time, "make it for this dt")
    return compensator
