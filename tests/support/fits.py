"""Fits made by hand, one of each kind, without the search."""

from __future__ import annotations

from typing import Any

import numpy as np

import lostmotion as lm
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.data import IdentificationData
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.likelihood.misfit import ResidualTests

VALVES: dict[str, Any] = {
    "dead zone": lm.DeadZone(48.7, 51.9, 1.3, 1.1),
    "backlash": lm.Backlash(1.7),
    "stiction": lm.Stiction(2.3, 0.7, "choudhury"),
    "saturation": lm.Saturation(42.0, 58.0),
    "none": lm.Identity(),
}


def made_fit(
    kind: str,
    status: lm.Status = lm.Status.OK,
    *,
    error: float = 0.03,
    op_noise: float = 0.05,
    closed_loop: bool = True,
    integrating: bool = False,
    widest: float | None = None,
    open_end: bool = False,
    rivals: tuple[tuple[float, float, float], ...] = (),
    seed: int = 0,
) -> lm.HammersteinFit:
    """Fit with these facts.

    Parameters
    ----------
    kind : str
        Key of VALVES.
    error : float
        Standard error of all parameters, as a share of 1.
    op_noise : float
        Deviation of the noise in OP; 0: OP is held.
    open_end : bool
        The record does not bound what is profiled.
    """
    random = np.random.default_rng(seed)
    valve = VALVES[kind]
    linear = (
        lm.LinearModel([-1.0], [0.05], 2, 0.5) if integrating else lm.LinearModel([-0.9, 0.07], [0.1, 0.03], 2, 0.5)
    )
    model = lm.Hammerstein(valve, linear, 20.0)
    n = 200
    u = np.repeat(random.uniform(45.0, 55.0, n // 20), 20) + op_noise * random.standard_normal(n)
    y = model.simulate(u) + 0.1 * random.standard_normal(n)
    parameters = {name: getattr(valve, name) for name in type(valve).own}
    if kind == "dead zone":
        parameters |= {"width": valve.width, "slope_ratio": valve.left_slope / valve.right_slope}
    own = dict(parameters)
    parameters |= {"gain": linear.gain} if integrating else {"gain": linear.gain, "offset": 20.0}
    parameters |= {"load": 0.3} if integrating else {}
    root = error * random.standard_normal((len(parameters), len(parameters)))
    covariance = root @ root.T / len(parameters)
    covariance[-1] = covariance[:, -1] = np.inf
    profiled = {}
    if kind in ("backlash", "stiction"):
        profiled = {
            name: (max(v - 1.7 * error, 0.0), np.inf if open_end else v + 2.9 * error) for name, v in own.items()
        }
    return lm.HammersteinFit(
        status=status,
        model=model,
        noise=lm.NoiseModel((-0.3,), 0.01),
        parameters=parameters,
        covariance=covariance,
        residuals=np.zeros(n),
        simulated=y,
        fit_percent=87.3,
        tests=ResidualTests(0.4, 0.6, 0.001, 0.002),
        evidence=Evidence(123.4, 456.7, 80, 90, rivals, closed_loop, 0.1),
        settings={"gain": None, "orders": "auto", "noise": "auto", "offset_fixed": False},
        widest=widest,
        data=IdentificationData(u, y, np.array([[0, n]]), 0.5, "FIC-101", "FIC-101.csv"),
        chosen=Chosen(len(linear.a), len(linear.b) - 1, 2, 1, integrating, ({"period": 31.7}, {"step_at": 40})),
        profiled=profiled,
    )
