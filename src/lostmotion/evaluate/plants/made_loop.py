"""MadeLoop: one loop of a made plant, with its process, valve and controller, as a process engineer would draw it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.kernels import coupled_loops as kernel
from lostmotion.models import Identity
from lostmotion.models.kernel_view import KernelActuator

TYPES = ("flow", "pressure", "level", "temperature")
LETTERS = {"flow": "F", "pressure": "P", "level": "L", "temperature": "T"}
UNITS = {"flow": "m3/h", "pressure": "bar", "level": "%", "temperature": "degC"}
SPANS = {
    "flow": ((0.0, 25.0), (0.0, 60.0), (0.0, 120.0), (0.0, 400.0)),
    "pressure": ((0.0, 6.0), (0.0, 16.0), (0.0, 40.0), (-1.0, 3.0)),
    "level": ((0.0, 100.0),),
    "temperature": ((0.0, 150.0), (0.0, 250.0), (100.0, 400.0), (-20.0, 120.0)),
}
GAINS = {"flow": (0.6, 1.6), "pressure": (0.5, 1.8), "level": (1.0, 1.0), "temperature": (0.5, 2.0)}
SLOW = {"flow": (1.0, 6.0), "pressure": (4.0, 120.0), "level": (1.0, 5.0), "temperature": (90.0, 900.0)}  # seconds
LAG_SHARE = {"flow": (0.1, 0.6), "pressure": (0.05, 0.4), "level": (0.1, 0.5), "temperature": (0.1, 0.5)}
DEAD_TIMES = {"flow": (0.0, 2.0), "pressure": (0.0, 6.0), "level": (0.0, 8.0), "temperature": (10.0, 90.0)}  # seconds
RESIDENCE = (150.0, 1500.0)  # seconds in which a full valve fills the vessel
SENSOR_LAGS = {"flow": (0.2, 1.5), "pressure": (0.2, 1.5), "level": (0.5, 5.0), "temperature": (5.0, 30.0)}
NOISE = {"flow": (0.08, 0.5), "pressure": (0.03, 0.25), "level": (0.03, 0.3), "temperature": (0.01, 0.08)}  # % of span
SHAKING = 0.3  # % of OP that noise moves it, at most: a loop in good order has its filter
SPEEDS = {"flow": (1.0, 3.0), "pressure": (1.0, 4.0), "level": (1.0, 4.0), "temperature": (0.8, 2.5)}  # of the closed
DRIFT = (0.1, 2.5)  # % of OP
REST = (30.0, 70.0)  # % of span, of OP and of PV
STROKES = (0.5, 4.0)  # seconds of the stem
CURVES = (-0.35, 0.35)  # installed characteristic: slope at the ends of the stroke over that in the middle, less 1


@dataclass(frozen=True)
class MadeLoop:
    """One loop; times in seconds, signals in % of span.

    Attributes
    ----------
    tag, area, loop_type : str
    op_rest, pv_rest : float
        Where it is at home.
    gain : float
        Of the process, % of PV per % of OP; of a level the sign of it.
    lags : (float, float)
        Time constants. Of a level: of what flows, and seconds in which the flow of a valve fully open fills it.
    dead_time, sensor, stroke, curve : float
        Dead time, lag of the sensor, lag of the stem, curvature of the characteristic.
    kp, ti, scan, filter : float
        PI controller: gain, integral time, seconds between its steps, lag of its filter.
    noise, drift : float
        Standard deviations: of the measurement; of the load that wanders, in % of OP.
    pv_span : (float, float)
        Engineering limits.
    tracks : bool
        SP follows PV in manual.
    master : int
        Number of the loop that sets its SP; -1: none.
    ratio : float
        % of SP per % of OP of the master.
    actuator : KernelActuator
        In deviations from `op_rest`.
    """

    tag: str
    area: str
    loop_type: str
    op_rest: float
    pv_rest: float
    gain: float
    lags: tuple[float, float]
    dead_time: float
    sensor: float
    stroke: float
    curve: float
    kp: float
    ti: float
    scan: float
    filter: float
    noise: float
    drift: float
    pv_span: tuple[float, float]
    tracks: bool
    master: int = -1
    ratio: float = 1.0
    actuator: KernelActuator = Identity()  # noqa: RUF009  frozen

    @property
    def integrates(self) -> bool:
        """Whether it is a vessel that does not settle by itself."""
        return self.loop_type == "level"

    @property
    def pace(self) -> float:
        """Seconds in which the closed loop answers, about."""
        if self.integrates:
            return self.ti / 4.0
        return max(self.lags[0] / max(abs(self.kp * self.gain), 0.1), self.ti / 4.0) + self.dead_time

    @property
    def pv_unit(self) -> str:
        """Engineering unit of PV."""
        return UNITS[self.loop_type]

    def row(self, dt: float) -> FloatArray:
        """Its numbers as :mod:`lostmotion.kernels.coupled_loops` wants them."""
        row = np.zeros(kernel.COLUMNS)
        row[kernel.KIND] = self.actuator.kernel_code
        row[kernel.FIRST : kernel.STROKE] = self.actuator.kernel_parameters()[: kernel.STROKE - kernel.FIRST]
        row[kernel.STROKE], row[kernel.CURVE] = share(dt, self.stroke), self.curve
        row[kernel.GAIN], row[kernel.LAG1] = self.gain, share(dt, self.lags[0])
        if self.integrates:
            row[kernel.RATE] = dt / self.lags[1]
        else:
            row[kernel.LAG2] = share(dt, self.lags[1])
        row[kernel.DELAY] = round(self.dead_time / dt)
        row[kernel.SENSOR], row[kernel.FILTER] = share(dt, self.sensor), share(dt, self.filter)
        scan = max(round(self.scan / dt), 1)
        row[kernel.KP], row[kernel.KI], row[kernel.SCAN] = self.kp, self.kp / self.ti * scan * dt, scan
        row[kernel.MASTER], row[kernel.RATIO] = self.master, self.ratio
        row[kernel.OP_REST], row[kernel.PV_REST] = self.op_rest, self.pv_rest
        row[kernel.TRACKS], row[kernel.LOW], row[kernel.HIGH] = float(self.tracks), 0.0, 100.0
        return row


def share(dt: float, lag: float) -> float:
    """Part of the way that a lag goes in a row."""
    return float(-np.expm1(-dt / lag)) if lag > 0.0 else 1.0


def made_loop(rng: np.random.Generator, tag: str, area: str, loop_type: str) -> MadeLoop:
    """Draw a loop in good order: tuned by Skogestad's rules, from brisk to lazy as plants are."""
    gain = _between(rng, GAINS[loop_type]) * (-1.0 if loop_type != "flow" and rng.random() < 0.4 else 1.0)
    slow = _between(rng, SLOW[loop_type])
    fast = slow * _between(rng, LAG_SHARE[loop_type])
    residence = _between(rng, RESIDENCE)
    dead = float(rng.uniform(*DEAD_TIMES[loop_type]))
    sensor, stroke = _between(rng, SENSOR_LAGS[loop_type]), _between(rng, STROKES)
    late = dead + fast + sensor + stroke
    speed = _between(rng, SPEEDS[loop_type])
    if loop_type == "level":
        closed = max(late, 0.05 * residence) * speed * float(rng.choice([1.0, 3.0]))  # tight, or averaging
        kp, ti = residence / (closed + late) / gain, 4.0 * (closed + late)
        lags = (slow, residence)
    else:
        closed = late * speed + (2.0 if loop_type == "flow" else 0.0)
        kp, ti = slow / (gain * (closed + late)), min(slow, 4.0 * (closed + late))
        lags = (slow, fast)
    if loop_type == "flow":  # mostly integral action: the noise of a flow is not to move the valve
        kp, ti = min(kp, 0.7 / gain), max(ti, float(rng.uniform(4.0, 15.0)))
    kp = float(np.clip(abs(kp), 0.05, 12.0) * np.sign(gain))
    noise = min(_between(rng, NOISE[loop_type]), SHAKING / abs(kp))
    filtered = float(rng.choice([0.0, 1.0, 2.0])) * sensor
    scan = float(rng.choice([1.0, 2.0, 5.0])) if loop_type == "temperature" else 1.0
    return MadeLoop(
        tag, area, loop_type, float(rng.uniform(*REST)), float(rng.uniform(*REST)), gain, lags, dead, sensor, stroke,
        float(rng.uniform(*CURVES)), kp, ti, scan, filtered, noise, _between(rng, DRIFT),
        SPANS[loop_type][int(rng.integers(len(SPANS[loop_type])))], bool(rng.random() < 0.5),
    )  # fmt: skip


def _between(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    """Even in the logarithm."""
    return float(np.exp(rng.uniform(*np.log(limits))))
