"""A process and its noise from a few numbers on the command line."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
import typer

from lostmotion.errors import ParameterError
from lostmotion.models import LinearModel, NoiseModel
from lostmotion.simulate import PI


def number(flag: str, help_: str) -> Any:
    """Option for a number without a default."""
    return typer.Option(flag, help=help_, show_default=False)


Gain = Annotated[float | None, number("--gain", "PV per unit of OP beyond the right break point, at rest.")]
Constants = Annotated[list[float] | None, number("--time-constant", "Seconds; may be repeated.")]
Integrating = Annotated[
    bool, typer.Option("--integrating", help="A level: --gain is the speed of PV per unit of OP, per second.")
]
DeadTime = Annotated[float, typer.Option("--dead-time", help="Seconds.")]
Deviation = Annotated[float | None, number("--noise-deviation", "Standard deviation of PV at rest.")]
Memory = Annotated[float, typer.Option("--noise-time", help="Seconds in which the noise forgets; 0: white.")]


def process_of(
    gain: float | None, constants: list[float], integrating: bool, dead_time: float, dt: float | None
) -> LinearModel:
    """Lags, dead time and perhaps an integrator, sampled.

    Raises
    ------
    ParameterError
        A number is missing, or a time constant is not positive.
    """
    if gain is None or dt is None or not (constants or integrating):
        raise ParameterError.expected(
            "--fit, or --gain, --time-constant (or --integrating) and --dt", "less", "see --help for an example"
        )
    if any(not constant > 0 for constant in constants):
        raise ParameterError.expected("--time-constant > 0", constants, "give seconds")
    den = np.array([1.0])
    for constant in constants:
        den = np.polymul(den, [constant, 1.0])
    process = LinearModel.from_continuous([gain], np.append(den, 0.0) if integrating else den, dead_time, dt)
    if not integrating:
        return process
    poles = process.poles
    poles[np.argmin(np.abs(poles - 1.0))] = 1.0  # exactly, not to rounding
    return LinearModel(tuple(np.real(np.poly(poles))[1:]), process.b, process.delay, process.dt)


def noise_of_numbers(deviation: float | None, memory: float, dt: float) -> NoiseModel:
    """Noise of a deviation and a memory.

    Raises
    ------
    ParameterError
        No deviation.
    """
    if deviation is None:
        raise ParameterError.expected("--noise-deviation", None, "give the standard deviation of PV at rest")
    if not memory > 0:
        return NoiseModel((), deviation**2)
    pole = math.exp(-dt / memory)
    return NoiseModel((-pole,), deviation**2 * (1.0 - pole**2))


def controller_of_numbers(kp: float | None, ki: float | None) -> PI | None:
    """PI where one of its gains is given."""
    return None if kp is None and ki is None else PI(kp or 0.0, ki or 0.0)
