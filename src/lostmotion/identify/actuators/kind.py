"""A kind of actuator: one object that owns all that estimation, comparison and reports know of it.

Whoever adds a kind writes a model (:mod:`lostmotion.models`), a family (how the likelihood sees it) and a ``Kind``,
and registers it; nothing else names kinds. What is forgotten raises at registration.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import ParameterError
from lostmotion.identify.actuators.actuator_lag import NO_LAG, Lag
from lostmotion.identify.actuators.operator_profile import seek
from lostmotion.identify.actuators.polish import polished, profile_intervals
from lostmotion.identify.actuators.sought import Sought
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.likelihood.asked import Asked
from lostmotion.identify.likelihood.family import Family
from lostmotion.identify.likelihood.fitted import Fitted
from lostmotion.identify.likelihood.problem import Problem
from lostmotion.identify.scaled import ScaledData, Scaling
from lostmotion.models import Nonlinearity

NEEDED = 3.0  # of log-likelihood, by which a fault must beat the linear model: 20 to 1
GLANCES = 9  # places of each form of a kind in a first look
CLASSES = ("dead_zone", "memory", "saturation")  # of evidence, each with a weight of its own in a diagnosis
SHAPES = ("never", "level", "always")


@dataclass(frozen=True)
class Words:
    """How people speak of a kind.

    Attributes
    ----------
    wider : str
        Begins "<wider> 2.1 would have been seen".
    unseen : str
        What is said where it is not seen and there is no size to bound.
    plural : str
    measure : str
        What its size measures.
    meanings : dict of str
        Of its parameters, for a table.
    extra : str
        Name of the parameter beside its size, where there is one.
    advice, advice_for_levels : tuple of str
        What to do about it, and what more behind an integrating process.
    """

    wider: str = ""
    unseen: str = ""
    plural: str = ""
    measure: str = "full width"
    meanings: Mapping[str, str] = field(default_factory=dict)
    extra: str = ""
    advice: tuple[str, ...] = ()
    advice_for_levels: tuple[str, ...] = ()


class Kind(ABC):
    """All that is known of one kind of actuator.

    Attributes
    ----------
    model : type
        Class of its model: names itself (``kind``), its parameters (``own``) and its size (``size_name``).
    family : type of Family
        How the likelihood sees it.
    words : Words
    evidence : str
        Class of evidence under which a diagnosis weighs it, of CLASSES.
    angular : {"never", "level", "always"}
        Where a loop with it can swing in triangles and squares: nowhere, behind an integrating process only, anywhere.
    sticks : bool
        It has a memory: the valve stays where it is until OP has gone far enough.
    has_slopes : bool
        A known static gain of the process separates slopes from the gain.
    break_points : tuple of str
        Parameters that are places on the axis of OP where its characteristic bends, from left to right.
    dead_between : bool
        Between these places nothing moves.
    anywhere : tuple of str
        Parameters that can be anything where the kind is not seen.
    searched : float
        Of log density: what the search for parameters that are held at the best place found costs, about the logarithm
        of the number of places.
    nests : str
        Kind that it becomes where its last parameter is 0; the fits of both begin at each other as well.
    slides : tuple of tuple of float
        Directions of its own parameters that leave its size, along which its likelihood is smooth.
    looks_like : str
        Kind with more local maxima that has the same shape seen from one side, and is sought wherever this one is.
    always_tried : bool
        Fitted also where its profile does not beat the linear model.
    begins_alone : bool
        Its search does not begin at the process of another kind.
    largest_share : float
        Of the range of OP: a size beyond it is not shown by moves inside that range.
    """

    model: ClassVar[type[Any]]
    family: ClassVar[type[Family]]
    words: ClassVar[Words]
    evidence: ClassVar[str]
    angular: ClassVar[str]
    sticks: ClassVar[bool] = False
    has_slopes: ClassVar[bool] = False
    break_points: ClassVar[tuple[str, ...]] = ()
    dead_between: ClassVar[bool] = False
    anywhere: ClassVar[tuple[str, ...]] = ()
    searched: ClassVar[float] = 0.0
    nests: ClassVar[str] = ""
    slides: ClassVar[tuple[tuple[float, ...], ...]] = ()
    looks_like: ClassVar[str] = ""
    always_tried: ClassVar[bool] = False
    begins_alone: ClassVar[bool] = False
    largest_share: ClassVar[float] = 0.97

    @property
    def name(self) -> str:
        """As in ``model.kind``."""
        return str(self.model.kind)

    @property
    def size(self) -> str | None:
        """Parameter that says how bad it is; None where there is none."""
        name: str | None = self.model.size_name
        return name

    @abstractmethod
    def forms(self, data: ScaledData) -> list[Family]:
        """Forms in which it is tried on a record."""

    def sought(self, data: ScaledData, asked: Asked) -> Sought:
        """Global search for the actuator by its profile: over the grid of every form, if there is no better way."""
        return seek(data, asked, self.forms(data))

    def of_size(self, problem: Problem, size: float) -> Iterator[tuple[Family, FloatArray]]:  # noqa: ARG002
        """Forms with own parameters that have this size, in scaled units of OP, wherever else they may lie."""
        return iter(())

    def met_by(self, u: FloatArray, own: FloatArray) -> FloatArray:  # noqa: ARG002
        """Nearest own parameters of the same size with which the actuator lies where OP goes."""
        return own

    def glance(self, data: ScaledData) -> list[tuple[Family, FloatArray]]:
        """A few places, spread over all that it can be, where a first look is taken before it is sought."""
        found = []
        for form in self.forms(data):
            places = form.grid(data.u, float(np.ptp(data.u)), data.u.size)[0]
            found += [(form, eta) for eta in places[:: max(len(places) // GLANCES, 1)]]
        return found

    def actuator(self, values: Mapping[str, float], family: Family) -> Nonlinearity:  # noqa: ARG002
        """Model with these parameters, in units of OP."""
        made: Nonlinearity = self.model(*(values[name] for name in self.model.own))
        return made

    def finished(self, fitted: Fitted) -> Fitted:
        """The maximum of the likelihood from a fit near it: last steps, where it has jumps."""
        return polished(fitted) if self.family.kinks else fitted

    def intervals(self, fitted: Fitted, scaling: Scaling) -> dict[str, tuple[float, float]]:
        """95 % intervals of parameters in units of OP by their profile, where curvature does not tell."""
        found = profile_intervals(fitted) if self.family.kinks else {}
        return {name: (scaling.u_scale * low, scaling.u_scale * high) for name, (low, high) in found.items()}

    def lag(self, fitted: Fitted) -> Lag:  # noqa: ARG002
        """What a lag in front of the actuator leaves of its parameters."""
        return NO_LAG

    def met(self, fitted: Fitted) -> bool:
        """Whether the record meets the actuator often enough for a fit of it to mean anything."""
        return self.meets(fitted.actuator, fitted.problem.u)

    def meets(self, own: FloatArray, u: FloatArray) -> bool:  # noqa: ARG002
        """The same of a command u (n,) and own parameters, both scaled."""
        return True

    def places_met(self, own: FloatArray, u: FloatArray) -> FloatArray:  # noqa: ARG002
        """Own parameters, infinite where they are places that the record does not meet."""
        return own

    def settled(self, fitted: Fitted, scaling: Scaling, offset: str) -> Fitted:  # noqa: ARG002
        """The fit after what else is to be decided of it, e.g. whether its offset is 0."""
        return fitted

    def simplest(self, fitted: Fitted) -> Fitted:
        """The fit with the fewest parameters that explains as much, for comparison with other kinds."""
        return fitted

    def healthy(self, fitted: Fitted, linear: Fitted) -> Fitted:  # noqa: ARG002
        """The likeliest model of a valve without this fault; the linear one, unless a fit of the kind is more than it.

        For kinds that a healthy characteristic which is no straight line would look like.
        """
        return linear

    def simplified(self, fitted: Fitted) -> Fitted:
        """The nested kind, begun at a fit of this one."""
        raise NotImplementedError(f"{self.name} nests {self.nests!r} but does not say how to begin it")

    def enriched(self, fitted: Fitted) -> Fitted:
        """The kind itself, begun at a fit of the nested one."""
        raise NotImplementedError(f"{self.name} nests {self.nests!r} but does not say how to begin there")

    def sought_again(self, fitted: Fitted, asked: Asked) -> Fitted | None:  # noqa: ARG002
        """A fit of this kind where a second search finds a likelier place than a fit of it or of the nested kind has.

        None where it finds none.
        """
        return None

    def handicapped(self, scores: Mapping[str, float], candidates: Mapping[str, Fitted]) -> float:  # noqa: ARG002
        """Its score beside those of the other kinds."""
        return scores[self.name]

    def widest(self, fitted: Fitted, profiled: Mapping[str, tuple[float, float]], scaling: Scaling) -> float | None:  # noqa: ARG002
        """Largest size that the record does not exclude, in units of OP; None where it has no size."""
        return None if self.size is None else profiled[self.size][1]

    def one_sided(
        self,
        evidence: Evidence,  # noqa: ARG002
        values: Mapping[str, float],  # noqa: ARG002
        covariance: FloatArray,  # noqa: ARG002
    ) -> bool:
        """Whether one side of it was hardly visited."""
        return False

    def unvisited(self, evidence: Evidence) -> tuple[str, ...]:  # noqa: ARG002
        """Parameters that are not known where it is one-sided."""
        return ()


_KINDS: dict[str, Kind] = {}


def register(kind: Kind) -> Kind:
    """Make a kind known to everything.

    Raises
    ------
    ParameterError
        Something of it is missing, or its name is taken.
    """
    missing = [name for name in ("model", "family", "words", "evidence", "angular") if not hasattr(kind, name)]
    if missing:
        raise ParameterError.expected("a whole kind", f"{type(kind).__name__} without {missing}", "add them")
    name = kind.name
    rules = (
        (kind.family.kind == name, f"a family of kind {name!r}", kind.family.kind),
        (kind.evidence in CLASSES, f"evidence out of {CLASSES}", kind.evidence),
        (kind.angular in SHAPES, f"angular out of {SHAPES}", kind.angular),
        (not kind.nests or kind.nests in _KINDS, "a nested kind that is registered", kind.nests),
        (name not in _KINDS, "a name of its own", name),
    )
    for holds, expected, got in rules:
        if not holds:
            raise ParameterError.expected(expected, repr(got), f"mend {type(kind).__name__}")
    if kind.size is not None and not kind.words.wider:
        raise ParameterError.expected("words for a size that was not seen", "none", "add words.wider")
    _KINDS[name] = kind
    return kind


def forget(name: str) -> None:
    """Make a kind unknown again, as tests need it."""
    _KINDS.pop(name, None)


def kind_of(name: str) -> Kind:
    """Kind of this name.

    Raises
    ------
    ParameterError
        Nobody registered it.
    """
    if name not in _KINDS:
        raise ParameterError.expected(f"a kind out of {list(_KINDS)}", repr(name), "register it")
    return _KINDS[name]


def faults() -> tuple[Kind, ...]:
    """All kinds of fault, in the order in which they were registered."""
    return tuple(kind for kind in _KINDS.values() if kind.name != NO_FAULT)


NO_FAULT = "none"


def kind_names() -> tuple[str, ...]:
    """Names of all kinds, "none" first."""
    return NO_FAULT, *(kind.name for kind in faults())
