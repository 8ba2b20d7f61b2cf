"""Verbs that lower layers offer and that higher ones carry out: read, plot, compensator, block, indices, summary.

A result lives low in the import order; what draws it or turns it into a block lives above. Each verb has a table of
names, from the class of a result to its function, and imports that function alone when it is called: nothing below
imports anything above, and a figure of a fit needs no package that only audits need.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import update_wrapper
from importlib import import_module
from operator import attrgetter
from typing import Any, Generic, TypeVar

from lostmotion.errors import ParameterError
from lostmotion.extras import extra
from lostmotion.panel import Panel

Answer = TypeVar("Answer")


class Verb(Generic[Answer]):
    """Function of a result, chosen by its class or the nearest base of it.

    Parameters
    ----------
    fallback : callable
        What happens for a class that is not in the table.
    room : str
        Package below ``lostmotion`` that all functions lie in.
    functions : mapping
        Class ("module:name" below ``lostmotion``) -> function ("module:name" below the room).
    """

    def __init__(self, fallback: Callable[..., Answer], room: str, functions: Mapping[str, str]) -> None:
        self._fallback = fallback
        self.functions = {f"lostmotion.{kind}": f"lostmotion.{room}.{name}" for kind, name in functions.items()}
        update_wrapper(self, fallback)

    def __call__(self, result: Any, **options: Any) -> Answer:
        """Carry it out."""
        bases = (f"{base.__module__}:{base.__qualname__}" for base in type(result).__mro__)
        name = next((self.functions[base] for base in bases if base in self.functions), None)
        return (self._fallback if name is None else named(name))(result, **options)


def named(path: str) -> Callable[..., Any]:
    """Function of a path "module:name"; where it needs a package of an extra that is missing, the error names it."""
    module, _, name = path.partition(":")
    with extra():
        function: Callable[..., Any] = attrgetter(name)(import_module(module))
    return function


def read(source: Any, **settings: Any) -> Any:
    """Record or records of a path, a frame or a mapping of columns."""
    return named("lostmotion.files.read_any:read_any")(source, **settings)


def _carried_out_in(room: str, functions: Mapping[str, str]) -> Callable[[Callable[..., Answer]], Verb[Answer]]:
    return lambda fallback: Verb(fallback, room, functions)


@_carried_out_in(
    "plot",
    {
        "actuator.response:ActuatorResponse": "actuator_figure:actuator_figure",
        "audit.plant_view:PlantView": "audit_figure:audit_figure",
        "design.designed:TestDesign": "design_figure:design_figure",
        "diagnose.diagnosis:Diagnosis": "diagnosis_figure:diagnosis_figure",
        "diagnose.pooled.pooled_diagnosis:PooledDiagnosis": "pooled_figure:pooled_figure",
        "evaluate.study.study_result:CompensationStudy": "study_figure:study_figure",
        "identify.fit:HammersteinFit": "fit_figure:fit_figure",
        "records.record:LoopRecord": "record_figure:record_figure",
        "simulate.response:LoopResponse": "loop_figure:loop_figure",
    },
)
def plot(result: Any, **options: Any) -> Any:
    """Figure of a result."""
    raise NotImplementedError(f"no figure for {type(result).__name__}")


@_carried_out_in(
    "compensate",
    {
        "models.dead_zone:DeadZone": "dead_zone_inverse:DeadZoneCompensator.from_dead_zone",
        "models.backlash:Backlash": "backlash_inverse:BacklashCompensator",
        "identify.rated_estimate:RatedEstimate": "derive:compensator_from_fit",
    },
)
def compensator(model: Any, **options: Any) -> Any:  # noqa: ARG001  those of the table take options
    """Ideal inverse of an actuator fault."""
    remedy = "for stiction use a block, which knocks or makes two moves; for other faults repair the actuator"
    raise ParameterError.expected("a dead zone or a backlash, which have an inverse", type(model).__name__, remedy)


@_carried_out_in("compensate", {"identify.rated_estimate:RatedEstimate": "derive:block_from_fit"})
def block(fit: Any, **options: Any) -> Any:  # noqa: ARG001  those of the table take options
    """Compensating block with safeguards, as it runs in a PLC."""
    raise ParameterError.expected("a fit to make a block from", type(fit).__name__, "use block_from_model()")


@_carried_out_in("evaluate", {"simulate.response:LoopResponse": "indices:loop_indices"})
def indices(result: Any, **options: Any) -> Any:
    """Indices of a response."""
    raise NotImplementedError(f"no indices for {type(result).__name__}")


@_carried_out_in(
    "report",
    {
        "actuator.response:ActuatorResponse": "actuator_text:actuator_summary",
        "audit.plant_view:PlantView": "audit_text:audit_summary",
        "design.achieve:Achievable": "design_text:achievable_summary",
        "design.designed:TestDesign": "design_text:design_summary",
        "diagnose.diagnosis:Diagnosis": "diagnosis_text:diagnosis_summary",
        "diagnose.pooled.pooled_diagnosis:PooledDiagnosis": "pooled_text:pooled_summary",
        "evaluate.monte_carlo:MonteCarloResult": "monte_carlo_text:monte_carlo_summary",
        "evaluate.solution:Solution": "solution_text:solution_summary",
        "evaluate.study.study_result:CompensationStudy": "study_text:study_summary",
        "identify.facts:FitFacts": "facts_text:facts_summary",
        "identify.fit:HammersteinFit": "fit_text:fit_summary",
        "identify.recursive.recursive_estimate:RecursiveEstimate": "recursive_text:recursive_summary",
    },
)
def text(result: Any, **options: Any) -> str:
    """Text of a result."""
    raise NotImplementedError(f"no summary for {type(result).__name__}")


@_carried_out_in(
    "report",
    {
        "actuator.response:ActuatorResponse": "tables:actuator_columns",
        "audit.plant_view:PlantView": "audit_notebook:audit_frame",
        "compensate.block:CompensatorBlock": "tables:block_columns",
        "design.achieve:Achievable": "tables:achievable_columns",
        "design.designed:TestDesign": "tables:design_columns",
        "diagnose.diagnosis:Diagnosis": "tables:diagnosis_columns",
        "diagnose.pooled.pooled_diagnosis:PooledDiagnosis": "tables:pooled_columns",
        "evaluate.monte_carlo:MonteCarloResult": "tables:monte_carlo_columns",
        "evaluate.solution:Solution": "tables:solution_columns",
        "evaluate.study.study_result:CompensationStudy": "tables:study_columns",
        "identify.facts:FitFacts": "tables:parameter_columns",
        "identify.fit:HammersteinFit": "tables:parameter_columns",
        "identify.recursive.recursive_estimate:RecursiveEstimate": "tables:parameter_columns",
        "records.checked:CheckedRecord": "tables:checked_columns",
        "records.report:RecordReport": "tables:report_columns",
    },
)
def frame(result: Any, **options: Any) -> Any:
    """Table of a result: columns by name, or a Polars frame."""
    raise NotImplementedError(f"no table of {type(result).__name__}")


@_carried_out_in(
    "report",
    {
        "actuator.response:ActuatorResponse": "notebook:actuator_panel",
        "audit.plant_view:PlantView": "audit_notebook:audit_panel",
        "compensate.block:CompensatorBlock": "notebook:block_panel",
        "design.achieve:Achievable": "notebook:achievable_panel",
        "design.designed:TestDesign": "notebook:design_panel",
        "diagnose.diagnosis:Diagnosis": "notebook:diagnosis_panel",
        "diagnose.pooled.pooled_diagnosis:PooledDiagnosis": "notebook:pooled_panel",
        "evaluate.monte_carlo:MonteCarloResult": "notebook:monte_carlo_panel",
        "evaluate.solution:Solution": "notebook:solution_panel",
        "evaluate.study.study_result:CompensationStudy": "notebook:study_panel",
        "identify.facts:FitFacts": "notebook:facts_panel",
        "identify.fit:HammersteinFit": "notebook:fit_panel",
        "identify.recursive.recursive_estimate:RecursiveEstimate": "notebook:recursive_panel",
        "records.checked:CheckedRecord": "notebook:checked_panel",
        "records.report:RecordReport": "notebook:report_panel",
    },
)
def panel(result: Any, **options: Any) -> Panel:
    """Headline and tables of a result."""
    raise NotImplementedError(f"no panel of {type(result).__name__}")


@_carried_out_in("report", {"identify.fit:HammersteinFit": "remarks_on_fit:fit_remarks"})
def remarks(result: Any, **options: Any) -> tuple[str, ...]:
    """Sentences about the data of a result."""
    raise NotImplementedError(f"no remarks on {type(result).__name__}")
