"""FitFacts: what is known of a fit without its signals, in memory as from its file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from lostmotion.arrays import FloatArray
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.files.results import read_json
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.rated_estimate import RatedEstimate
from lostmotion.identify.saved_fit import REMEDY, facts_from_dict, finite
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.records.compression import MadeUp


@dataclass(frozen=True, eq=False, repr=False)
class FitFacts(RatedEstimate):
    """A known fit: what :class:`HammersteinFit` found, without residuals and record.

    ``fit.facts`` gives it, ``lostmotion.read_fit(path)`` reads it from what ``fit.save(path)`` wrote. Blocks, studies,
    designs and exports are made from it, so that they come out the same from memory and from a file.

    Attributes
    ----------
    status : Status
    model : Hammerstein
    noise : NoiseModel
    parameters, covariance, profiled, widest, evidence, fit_percent
        As in :class:`HammersteinFit`. A covariance that is not known is infinite.
    chosen : Chosen
        Structure of the model.
    known_gain : float or None
        Static gain that the identification was told.
    op_range : (float, float)
        Smallest and largest OP of the record.
    op_span : (float, float) or None
        Span of OP, where it was known.
    op_noise : float or None
        Standard deviation of the noise in OP, 0 where OP is held; None where a file of an older version does not say.
    dt : float
        Sampling time in seconds.
    samples : int
    tag, source, fingerprint : str
        Of the data.
    kinds : KindChoice or None
        How the kinds compare, where they were compared.
    made_up : MadeUp or None
        Shares of the rows of OP and PV that a historian made up; None where a file of an older version does not say.
    """

    status: Status
    model: Hammerstein
    noise: NoiseModel
    parameters: dict[str, float]
    covariance: FloatArray
    fit_percent: float
    evidence: Evidence
    widest: float | None
    chosen: Chosen
    known_gain: float | None
    op_range: tuple[float, float]
    op_noise: float | None
    dt: float
    samples: int
    tag: str = ""
    source: str = ""
    fingerprint: str = ""
    profiled: dict[str, tuple[float, float]] = field(default_factory=dict)
    kinds: KindChoice | None = None
    made_up: MadeUp | None = None
    op_span: tuple[float, float] | None = None

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return self.found_in_words, self.status.name, f"{self.samples} samples"

    def __post_init__(self) -> None:
        parameters = {name: float(value) if np.isfinite(value) else np.inf for name, value in self.parameters.items()}
        covariance = np.where(np.isfinite(self.covariance), self.covariance, np.inf)
        covariance.flags.writeable = False
        profiled = {name: (float(low), float(high)) for name, (low, high) in self.profiled.items()}
        for name, value in (("parameters", parameters), ("covariance", covariance), ("profiled", profiled)):
            object.__setattr__(self, name, value)

    @property
    def facts(self) -> FitFacts:
        """Itself."""
        return self

    @property
    def closed_loop(self) -> bool:
        """OP answers PV."""
        return self.evidence.closed_loop

    @property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """95 % interval of each parameter; an end that is not known is infinite."""
        return {name: self.interval(name) for name in self.parameters}

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: the part of ``HammersteinFit.to_dict()`` that :meth:`from_dict` reads. Infinite is None."""
        return {
            "status": self.status.name,
            "message": self.message,
            "preferred": self.preferred,
            "model": self.model.to_dict(),
            "noise": self.noise.to_dict(),
            "parameters": {name: finite(value) for name, value in self.parameters.items()},
            "standard_errors": {name: finite(value) for name, value in self.standard_errors.items()},
            "covariance": [[finite(value) for value in row] for row in self.covariance],
            "intervals_95": {name: [finite(end) for end in ends] for name, ends in self.intervals.items()},
            "size_interval_95": [finite(end) for end in self.size_interval],
            "profiled": {name: [finite(end) for end in ends] for name, ends in self.profiled.items()},
            "fit_percent": self.fit_percent,
            "widest": None if self.widest is None else finite(self.widest),
            "evidence": dict(vars(self.evidence)),
            "kinds": None if self.kinds is None else self.kinds.to_dict(),
            "settings": {"gain": self.known_gain, "chosen": self.chosen.to_dict()},
            "data": {
                "tag": self.tag,
                "source": self.source,
                "samples": self.samples,
                "op_range": list(self.op_range),
                "op_noise": self.op_noise,
                "made_up": None if self.made_up is None else self.made_up.to_dict(),
                "dt": self.dt,
                "fingerprint": self.fingerprint,
                **({} if self.op_span is None else {"op_span": list(self.op_span)}),
            },
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """Facts from ``to_dict()`` of a fit or of facts, also after a passage through JSON.

        Raises
        ------
        DataError
            Something is missing, of another type, or contradicts itself.
        """
        facts = cls(**facts_from_dict(data))
        if data["preferred"] != facts.preferred:
            got = f"{data['preferred']!r} beside status {facts.status.name}"
            raise DataError.expected(f"preferred {facts.preferred!r} in a fit", got, REMEDY)
        return facts


def facts_of(fit: RatedEstimate | Mapping[str, Any]) -> FitFacts:
    """Facts of a fit, of facts, or of the dictionary of a fit: the door of all that take any of them.

    Raises
    ------
    ParameterError
        Something else.
    DataError
        A dictionary of something else.
    """
    if isinstance(fit, RatedEstimate):
        facts: FitFacts = fit.facts
        return facts
    if isinstance(fit, Mapping):
        return FitFacts.from_dict(fit)
    raise ParameterError.expected("a fit", type(fit).__name__, "give what identify() or read_fit() returns")


def read_fit(path: str | os.PathLike[str]) -> FitFacts:
    """Fit from the JSON that ``fit.save(path)`` or ``lostmotion identify --out`` wrote.

    Raises
    ------
    FileAccessError
        The file is not there or not readable.
    DataError
        It is not the JSON of a fit.
    """
    return FitFacts.from_dict(read_json(path, "a fit", REMEDY))
