"""What a loop of `other_simulation.py` is made of, and what is true of it.

OP, travel and PV in % of span, times in rows of the record.
"""

from __future__ import annotations

from dataclasses import dataclass

STICKING = ("backlash", "stiction")  # named for each other they are the right family
KINDS = (*STICKING, "dead zone")
SECONDS = {"flow": 1.0, "pressure": 1.0, "temperature": 10.0, "level": 5.0}  # in a row


@dataclass(frozen=True)
class ProcessSpec:
    """Kind of process; None is drawn."""

    kind: str  # of SECONDS
    lag: float | None = None
    dead_time: float | None = None
    second_lag: float | None = None
    gain: float | None = None


@dataclass(frozen=True)
class ValveSpec:
    """Fault of the valve and its actuator; sizes in % of travel."""

    rule: str = ""  # of RULES
    band: float = 0.0  # S, full width; of a dead zone the width
    jump: float = 0.0  # J
    downward: float = 1.0  # friction downward over that upward
    growth: tuple[float, float] = (1.0, 1.0)  # of the size, from begin to end of the record
    sudden: bool = False  # the growth comes at once, in the middle
    zone_offset: float = 0.0  # of the dead zone's middle from OP at rest
    lag: float | None = None  # drawn where None
    rate_limit: float = 0.0  # %/row; 0: none
    positioner_gain: float = 0.0  # 1/row; 0: none
    equal_percentage: bool = False


@dataclass(frozen=True)
class ControllerSpec:
    """Tuning and what a controller has besides."""

    tuning: str | None = None  # of PACE; drawn where None
    share_of_ultimate: float = 0.88  # gain of a ringing loop over that at which it swings for ever
    derivative_time: float = 0.0
    dead_band: float = 0.0  # of the error, %
    limits: tuple[float, float] = (0.0, 100.0)
    output_step: float = 0.0  # of OP, %
    manual_phases: int = 0
    op_at_rest: float | None = None  # drawn where None
    feedforward: float = 0.0  # share of the load that is measured and taken off OP at once


@dataclass(frozen=True)
class SetPointSpec:
    """How the set point goes."""

    course: str | None = None  # "rest", "moves", "cascade"; one of the first two is drawn where None
    size: float = 5.0  # %: largest move, or standard deviation
    spacing: float | None = None  # between moves; some settling times where None
    correlation: float = 80.0  # time of a cascade's


@dataclass(frozen=True)
class LoadSpec:
    """What disturbs the loop, in % of flow at the valve; drift in % of PV."""

    deviation: float = 0.4  # of the load that is always there
    correlation: float | None = None  # its time; three times that of the closed loop where None
    steps: float = 0.0  # standard deviation of steps, one in 250 rows
    sine: float = 0.0  # amplitude
    sine_wander: float = 0.4  # of that amplitude
    sawtooth: float = 0.0
    square: float = 0.0
    drift: float = 0.0  # deviation of a random walk at the end of the record


@dataclass(frozen=True)
class TransmitterSpec:
    """What is between PV and the controller."""

    noise: float = 0.1  # %, standard deviation
    outliers: bool = False  # upward, in 5 % of the scans
    filter_lag: float = 0.0
    step: float = 0.0  # %


@dataclass(frozen=True)
class HistorianSpec:
    """Record; None is drawn."""

    rows: int | None = None  # with those before it settles
    scans: int | None = None  # of the controller in a row
    fine_steps: int | None = None  # in a scan
    compression: str = ""  # "hold" or "linear": how it fills rows between stored values
    pv_deviation: float = 0.0  # %: stored is what is off by more
    op_deviation: float = 0.0
    pv_late: float = 0.0  # rows by which PV is recorded after OP


@dataclass(frozen=True)
class LoopSpec:
    """A loop: its class and what is true of it, and what it is made of."""

    group: str
    truth: str  # "none", "tuning", "disturbance", "saturation" or a kind of lost motion
    process: ProcessSpec
    valve: ValveSpec = ValveSpec()
    controller: ControllerSpec = ControllerSpec()
    set_point: SetPointSpec = SetPointSpec()
    load: LoadSpec = LoadSpec()
    transmitter: TransmitterSpec = TransmitterSpec()
    historian: HistorianSpec = HistorianSpec()

    @property
    def lost_motion(self) -> bool:
        """Whether the valve has a fault that is to be named."""
        return self.truth in KINDS

    @property
    def width(self) -> float:
        """Of the lost motion in % of OP; the largest where it grows."""
        return self.valve.band * (1.0 + self.valve.downward) / 2.0

    @property
    def one_width(self) -> bool:
        """Whether a width is true of the whole record: it does not grow, and OP itself is what the valve obeys."""
        return self.lost_motion and self.valve.growth == (1.0, 1.0) and not self.valve.positioner_gain
