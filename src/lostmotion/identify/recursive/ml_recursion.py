"""The recursion of RecursiveML after its start: samples in units of the user, changes, what is forgotten on request."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.parameters import named_values
from lostmotion.identify.recursive.change import react, relinearise
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent
from lostmotion.identify.recursive.remembered import Memory, forget
from lostmotion.identify.scaled import Scaling
from lostmotion.kernels.recursive_ml import run as kernel
from lostmotion.kernels.recursive_ml import state as ml
from lostmotion.kernels.threads import one_thread

MOST_EVENTS = 100  # that are kept: the state does not grow
TESTED = ("left", "right", "gain", "offset")  # the values in which an event says what has changed
SHOWN_AS = {"both": ["left", "right"], "all": ["process", "left", "right"]}
_RUN: Any = kernel.run  # compiled: no signature that a type checker knows
_ONE: Any = kernel.one


@dataclass(eq=False)
class Recursion:
    """State of the kernel and its units.

    Attributes
    ----------
    state, layout : ndarray
        Of the kernel, see :mod:`lostmotion.kernels.recursive_ml.state`.
    scales : (float, float)
        One unit of the kernel's u and y in units of the user.
    before : int
        Samples before those that the kernel counts.
    events : list of ChangeEvent
        The last ones, oldest first.
    """

    settings: Settings
    state: FloatArray
    layout: IntArray
    scales: tuple[float, float]
    before: int
    events: list[ChangeEvent] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._psi = np.zeros(self.n)  # room for a gradient

    @property
    def n(self) -> int:
        """Length of theta."""
        return int(self.layout[ml.N])

    @property
    def samples(self) -> int:
        """Samples seen."""
        return int(self.layout[ml.COUNT]) + self.before

    @property
    def memory(self) -> Memory:
        """View of the state."""
        return Memory(self.state, self.layout)

    @property
    def scaling(self) -> Scaling:
        """Units, as the batch estimator has them; nothing is centred."""
        return Scaling(0.0, self.scales[0], 0.0, self.scales[1])

    def update(self, u: float, y: float, use: bool) -> float:
        """Take one sample; its prediction error."""
        scale_u, scale_y = self.scales
        error, reason = _ONE(u / scale_u, y / scale_y, use, self.state, self.layout, self._psi)
        if reason:
            self._look(reason)
        return float(error) * scale_y

    def run(
        self, u: FloatArray, y: FloatArray, use: npt.NDArray[np.bool_], first: int, every: int
    ) -> tuple[FloatArray, FloatArray]:
        """Take the samples from `first` on; rows of theta after every `every`-th of all, and prediction errors."""
        trace, errors = np.empty((u.size // every, self.n)), np.empty(u.size)
        scaled_u, scaled_y = u / self.scales[0], y / self.scales[1]
        at = first
        while at < u.size:
            at, reason = _RUN(scaled_u, scaled_y, use, at, self.state, self.layout, errors, every, trace)
            if reason:
                self._look(reason)
        return trace[first // every :], errors[first:] * self.scales[1]

    @one_thread
    def _look(self, reason: int) -> None:
        """What the kernel cannot decide: explain an alarm, or fit the samples since a change again."""
        if reason == kernel.REFIT:
            relinearise(self.state, self.layout)
            return
        found = react(self.state, self.layout)
        if found is None:
            return
        kind, before, after, covariance, since = found
        old, _ = self._tested(before)
        new, jacobian = self._tested(after)
        spread = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian), 0.0))
        for name in SHOWN_AS.get(kind, [kind]):
            i = TESTED.index("gain" if name == "process" else name)
            event = ChangeEvent(self.samples, since + self.before, name, old[i], new[i], float(spread[i]))
            self.events = [*self.events, event][-MOST_EVENTS:]

    def _tested(self, theta: FloatArray) -> tuple[list[float], FloatArray]:
        """Left, right, static gain from OP to PV beyond right, and offset, with their derivatives."""
        values, jacobian = named_values(theta, DeadZoneFamily, self.settings.na, self.settings.nb, self.scaling, None)
        names = list(values)
        return [values[name] for name in TESTED], jacobian[[names.index(name) for name in TESTED]]

    def forget(self, names: tuple[str, ...]) -> None:
        """Forget what is known about some parameters; see ``RecursiveML.reset``."""
        memory = self.memory
        eta = memory.eta
        places = {"left": [eta], "right": [eta + 1], "slope_ratio": [eta + 2], "process": list(range(eta))}
        places["noise"] = list(range(eta + 3, memory.n))
        for name in names:
            if name not in places:
                raise ParameterError.expected(f"names out of {list(places)}", repr(name), "choose one of them")
        chosen = sorted({index for name in names for index in places[name]})
        weak = memory.variance / np.maximum(1.0, np.abs(memory.theta)) ** 2
        memory.refer_to(forget(memory.older_than(0), chosen, weak))
        memory.parts["sum_h"][:], memory.parts["sum_g"][:] = 0.0, 0.0  # samples from before in the open block
        self.layout[ml.EXPLAIN_AT], self.layout[ml.REFIT_AT] = 0, ml.NEVER  # neither looks back beyond it
        self.layout[ml.SINCE] = self.layout[ml.COUNT]
        self.layout[ml.FROM_BLOCK] = self.layout[ml.BLOCKS] + (self.layout[ml.FILLED] > 0)
        memory.solve()
