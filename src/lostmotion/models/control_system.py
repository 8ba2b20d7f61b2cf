"""Models as systems of python-control."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.extras import extra
from lostmotion.kernels import actuator as kernel
from lostmotion.models.kernel_view import KernelActuator
from lostmotion.working_folder import MATPLOTLIB_FILE, without_settings

if TYPE_CHECKING:
    from lostmotion.models.hammerstein import Hammerstein

MEMORY = ("position", "last OP", "OP at the last stop", "direction", "moving", "stopped without a turn")


def nonlinear_system(model: Hammerstein, load: float = 0.0) -> Any:
    """Return a ``NonlinearIOSystem`` in discrete time from OP to PV; see :meth:`Hammerstein.to_control`.

    Its state is the memory of the actuator, if it has one, with a first number that is 0 until the first sample, and
    the linear part in observer form.

    Raises
    ------
    ParameterError
        An actuator that no kernel simulates.
    """
    with extra("control"), without_settings(MATPLOTLIB_FILE):
        import control  # noqa: PLC0415  optional extra
    valve = model.nonlinearity
    if not isinstance(valve, KernelActuator):
        remedy = "use one of lm.DeadZone, Backlash, Stiction, Saturation, Identity"
        raise ParameterError.expected("an actuator that loops can simulate", type(valve).__name__, remedy)
    code, parameters = valve.kernel_code, valve.kernel_parameters()
    kept = 1 if code == kernel.BACKLASH else len(MEMORY) if code >= kernel.STICTION else 0
    own = kept + 1 if kept else 0
    a, b = _polynomials(model)

    def actuator(state: FloatArray, op: float) -> tuple[float, FloatArray]:
        memory = kernel.init(np.nan)
        if own and state[0] > 0.0:
            memory[:kept] = state[1:own]
        x = float(kernel.step(code, parameters, memory, op))
        return x + load, np.concatenate([[1.0], memory[:kept]]) if own else memory[:0]

    def update(_time: float, state: FloatArray, op: FloatArray, _params: Any) -> FloatArray:
        x, memory = actuator(state, float(op[0]))
        linear = np.append(state[own:], 0.0)
        y = linear[0] + b[0] * x
        return np.concatenate([memory, linear[1:] + b[1:] * x - a * y])

    def output(_time: float, state: FloatArray, op: FloatArray, _params: Any) -> FloatArray:
        direct = b[0] * actuator(state, float(op[0]))[0] if b[0] else 0.0
        return np.array([(state[own] if len(state) > own else 0.0) + direct + model.offset])

    names = ["started", *MEMORY[:kept]] if own else []
    names += [f"linear {number + 1}" for number in range(a.size)]
    return control.nlsys(update, output, inputs=["OP"], outputs=["PV"], states=names, dt=model.linear.dt)


def _polynomials(model: Hammerstein) -> tuple[FloatArray, FloatArray]:
    """a1 .. an and b0 .. bn of one order, the delay in the zeros that b begins with."""
    linear = model.linear
    order = max(linear.delay + len(linear.b) - 1, len(linear.a))
    b = np.zeros(order + 1)
    b[linear.delay : linear.delay + len(linear.b)] = linear.b
    return np.pad(np.array(linear.a, dtype=np.float64), (0, order - len(linear.a))), b
