"""A process, its noise and its controller from a few numbers: options, or a file that holds them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.arguments import finite, seconds
from lostmotion.cli.options import number
from lostmotion.errors import DataError, FileAccessError, ParameterError
from lostmotion.files.schema import parsed, toml_of

if TYPE_CHECKING:
    from lostmotion.models import LinearModel, NoiseModel
    from lostmotion.simulate import PI

KEYS = (  # what a model file may hold: the names of the options
    *("left", "right", "slope_ratio", "width", "band", "jump"),
    *("gain", "time_constant", "integrating", "dead_time", "dt", "noise_deviation", "noise_time"),
    *("kp", "ki", "pv_now", "op_now"),
)


def take_numbers(ctx: typer.Context, path: Path | None) -> Path | None:
    """Let the numbers of a file stand where the command line gives none.

    Raises
    ------
    FileAccessError
        The file is absent or not readable.
    DataError
        It is neither TOML nor JSON.
    ParameterError
        It holds something that the command does not know.
    """
    if path is not None:
        options = {one.name: one for one in ctx.command.params if one.name in KEYS}
        found = {name.replace("-", "_"): value for name, value in _read(path).items()}
        for name in found:
            if name not in options:
                raise ParameterError.expected(f"{path} with some of {', '.join(options)}", name, "mend or remove it")
        many = {name for name, option in options.items() if getattr(option, "multiple", False)}
        ctx.default_map = {
            name: [value] if name in many and not isinstance(value, list) else value for name, value in found.items()
        }
    return path


def _read(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
        data = parsed(text) if path.suffix.lower() == ".json" else toml_of(text)
    except OSError as error:
        raise FileAccessError(f"expected a readable {path}, got {error.strerror}; check the path") from error
    except ValueError as error:
        raise DataError.expected("lines like gain = 1.5 (TOML), or JSON", f"{path}: {error}", "mend them") from error
    if not isinstance(data, dict):
        raise DataError.expected("names and numbers", f"other JSON in {path}", 'e.g. {"gain": 1.5}')
    return data


Model = Annotated[
    Path | None,
    typer.Option(
        "--model",
        help="File (TOML or JSON) with the numbers of a rough model, e.g. gain = 1.5; options here win over it.",
        show_default=False,
        callback=take_numbers,
        is_eager=True,
    ),
]
Gain = Annotated[float | None, number("--gain", "PV per unit of OP beyond the right break point, at rest.")]
Constants = Annotated[list[float] | None, number("--time-constant", "Seconds; may be repeated.")]
Integrating = Annotated[
    bool, typer.Option("--integrating", help="A level: --gain is the speed of PV per unit of OP, per second.")
]
DeadTime = Annotated[float, typer.Option("--dead-time", help="Seconds.")]
Dt = Annotated[
    float | None, number("--dt", "Sampling time in seconds: of a rough model, or of a record without times.")
]
Deviation = Annotated[float | None, number("--noise-deviation", "Standard deviation of PV at rest.")]
Memory = Annotated[float, typer.Option("--noise-time", help="Seconds in which the noise forgets; 0: white.")]
Kp = Annotated[float | None, number("--kp", "Gain of the PI controller; default: from the record, where it tells.")]
Ki = Annotated[float | None, number("--ki", "Integral gain of it, units of OP per unit of PV and second.")]


@dataclass(frozen=True)
class RoughModel:
    """Lags, dead time and perhaps an integrator, with noise; sampled every `dt` seconds."""

    model: Model = None
    gain: Gain = None
    time_constant: Constants = None
    integrating: Integrating = False
    dead_time: DeadTime = 0.0
    dt: Dt = None
    noise_deviation: Deviation = None
    noise_time: Memory = 0.0

    @property
    def process(self) -> LinearModel:
        """Process, sampled.

        Raises
        ------
        ParameterError
            A number is missing, or a time constant is not positive.
        """
        import numpy as np

        constants = self.time_constant or []
        if self.gain is None or self.dt is None or not (constants or self.integrating):
            raise ParameterError.expected(
                "--fit, or --gain, --time-constant (or --integrating) and --dt",
                "less",
                "see --help for an example, or use --model",
            )
        if any(not constant > 0 for constant in constants):
            raise ParameterError.expected("--time-constant > 0", constants, "give seconds")
        den = np.array([1.0])
        for constant in constants:
            den = np.polymul(den, [seconds("--time-constant", constant), 1.0])
        if self.integrating:
            den = np.append(den, 0.0)
        process = lm.LinearModel.from_continuous([finite("gain", self.gain)], den, self.dead_time, self.dt)
        if not self.integrating:
            return process
        poles = process.poles
        poles[np.argmin(np.abs(poles - 1.0))] = 1.0  # exactly, not to rounding
        return lm.LinearModel(tuple(np.real(np.poly(poles))[1:]), process.b, process.delay, process.dt)

    @property
    def noise(self) -> NoiseModel:
        """Noise of PV.

        Raises
        ------
        ParameterError
            No deviation, or no sampling time.
        """
        if self.noise_deviation is None:
            raise ParameterError.expected("--noise-deviation", None, "give the standard deviation of PV at rest")
        if not self.noise_time > 0:
            return lm.NoiseModel((), self.noise_deviation**2)
        pole = math.exp(-self.process.dt / self.noise_time)
        return lm.NoiseModel((-pole,), self.noise_deviation**2 * (1.0 - pole**2))


@dataclass(frozen=True)
class ControllerOptions:
    """PI controller."""

    kp: Kp = None
    ki: Ki = None

    @property
    def controller(self) -> PI | None:
        """PI where one of its gains is given."""
        return None if self.kp is None and self.ki is None else lm.PI(self.kp or 0.0, self.ki or 0.0)
