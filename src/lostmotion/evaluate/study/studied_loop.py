"""What is known of the loop: the model, its noise, how sure they are, and where OP was."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lostmotion.arguments import finite
from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError
from lostmotion.evaluate.study.study_plant import StudyPlant
from lostmotion.evaluate.tuning import integrates
from lostmotion.identify import HammersteinFit
from lostmotion.models import (
    Backlash,
    DeadZone,
    Hammerstein,
    LinearModel,
    NoiseModel,
    Nonlinearity,
    Stiction,
)

VALVES: dict[str, type[DeadZone] | type[Backlash] | type[Stiction]] = {
    "dead zone": DeadZone,
    "backlash": Backlash,
    "stiction": Stiction,
}
OWN = {
    "dead zone": ("left", "right", "left_slope", "right_slope"),
    "backlash": ("width",),
    "stiction": ("band", "jump"),
}


@dataclass(frozen=True)
class Known:
    """A plant, its noise, and the uncertainty of both.

    Attributes
    ----------
    plant : StudyPlant
    noise : NoiseModel
    parameters, covariance : dict of float and ndarray
        Of a fit, in one order; both empty where the model was given by numbers.
    op_range : (float, float) or None
        Of the record.
    source : str
        Where the model comes from, in words.
    """

    plant: StudyPlant
    noise: NoiseModel
    parameters: dict[str, float] = field(default_factory=dict)
    covariance: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    op_range: tuple[float, float] | None = None
    source: str = "a model given by numbers"

    @property
    def errors(self) -> dict[str, float]:
        """Standard errors that are known."""
        deviations = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        found = zip(self.parameters, deviations.tolist(), strict=True)
        return {name: error for name, error in found if np.isfinite(error)}


def known(model: Hammerstein | HammersteinFit | Mapping[str, Any], noise: NoiseModel | float | None) -> Known:
    """From a fit, the dictionary of a fit, or a model with its noise.

    Raises
    ------
    ParameterError
        An actuator without lost motion, noise beside a fit, or a model without noise.
    DataError
        A dictionary of something else, or a fit that shows no lost motion.
    """
    if isinstance(model, Hammerstein):
        _refuse_kind(model.nonlinearity)
        if noise is None:
            raise ParameterError.expected("the noise beside a model", None, "give its variance, 0 for none")
        made = noise if isinstance(noise, NoiseModel) else NoiseModel((), finite("noise variance", noise))
        return Known(StudyPlant(model), made)
    if noise is not None:
        raise ParameterError.expected("a fit alone", "a fit and noise", "the fit has its own noise model")
    if isinstance(model, HammersteinFit):
        op = (float(model.data.u.min()), float(model.data.u.max()))
        return _from_dict({**model.to_dict(), "op_range": op})
    return _from_dict(model)


def valve_of(data: Mapping[str, Any]) -> Nonlinearity:
    """Actuator from its dictionary.

    Raises
    ------
    DataError
        A kind without a block.
    """
    kind = str(data.get("kind"))
    if kind not in VALVES:
        raise DataError.expected("a fit that shows a lost motion", kind, "other faults have no block: mend them")
    return VALVES[kind].from_dict(dict(data))


def _refuse_kind(valve: Nonlinearity) -> None:
    if valve.kind not in VALVES:
        raise ParameterError.expected(
            "an actuator with a dead zone, backlash or stiction", valve.kind, "other faults have no block: mend them"
        )


def _from_dict(data: Mapping[str, Any]) -> Known:
    if not {"status", "preferred", "model", "noise", "parameters", "covariance", "data"} <= data.keys():
        raise DataError.expected("the dictionary of a fit", sorted(data), "use identify --out")
    parts = data["model"]
    kind = parts["nonlinearity"].get("kind")
    if data["preferred"] != kind:
        got = f"{data['preferred']} (status {data['status']})"
        raise DataError.expected("a fit that shows a lost motion", got, data.get("message", "record more moves of OP"))
    model = Hammerstein(valve_of(parts["nonlinearity"]), LinearModel.from_dict(parts["linear"]), parts["offset"])
    covariance = np.array(
        [[np.inf if value is None else value for value in row] for row in data["covariance"]], dtype=np.float64
    )
    parameters = {name: np.inf if value is None else float(value) for name, value in data["parameters"].items()}
    about = data["data"]
    op = data.get("op_range", about.get("op_range"))
    return Known(
        StudyPlant(model, _load(model, parameters, op)),
        NoiseModel(tuple(data["noise"]["d"]), data["noise"]["variance"]),
        parameters,
        covariance,
        None if op is None else (float(op[0]), float(op[1])),
        f"a fit of {about['samples']} samples{' of ' + about['tag'] if about.get('tag') else ''}, "
        f"status {data['status']}",
    )


def _load(model: Hammerstein, parameters: Mapping[str, float], op: Sequence[float] | None) -> float:
    """Load of an integrating process: as fitted, or such that OP rests in the middle of its range."""
    if not integrates(model.linear):
        return 0.0
    if "load" in parameters:
        return parameters["load"] * parameters.get("right_slope", 1.0)
    if op is None or isinstance(model.nonlinearity, DeadZone):
        return 0.0
    return -0.5 * (op[0] + op[1])
