"""What a fit and a saved fit have in common: a status, what it supports, and intervals that keep to it."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from lostmotion import _verbs
from lostmotion.brief import between
from lostmotion.distributions import normal_quantile
from lostmotion.errors import Status
from lostmotion.files.results import write_json
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.identify.actuators.kind import NO_FAULT, Kind, kind_of
from lostmotion.identify.chosen import Chosen
from lostmotion.identify.evidence import Evidence
from lostmotion.identify.named_estimate import NamedEstimate
from lostmotion.identify.predicted import Predictor
from lostmotion.identify.size_interval import slips_at_rest, with_model_error
from lostmotion.identify.unseen_moves import beyond_unseen, within_unseen
from lostmotion.summary import Summary

POSITIVE = ("left_slope", "right_slope", "slope_ratio")
HIDDEN = (Status.NOT_SEEN, Status.CANNOT_TELL, Status.SAME_SIGNAL)  # no number is given for the fault, only a bound
SEEN = (
    Status.COLOURED,
    Status.WIDE,
    Status.FEW_CROSSINGS,
)  # not as it should be, but the kind is what the record shows
LINEAR = "Converged; a linear model describes the record"  # status OK where no lost motion was fitted
EVEN_ODDS = 6.0  # BIC behind: another maximum that is less unlikely than 1 to 20 belongs into the interval


class RatedEstimate(NamedEstimate, ABC):
    """Base of :class:`HammersteinFit` and :class:`FitFacts`."""

    status: Status
    evidence: Evidence
    kinds: KindChoice | None
    widest: float | None
    profiled: dict[str, tuple[float, float]]
    chosen: Chosen

    @property
    def nuisances(self) -> tuple[str, ...]:
        """What a sound plant may do and this record needed in the model, beside the fault and a linear process.

        Out of "direction-dependent lag" (`chosen.asymmetry`), "bent characteristic" (`chosen.slopes`), "actuator
        lag" (`evidence.actuator_lag`) and "break-away" (`chosen.break_away`).
        """
        needed = {
            "direction-dependent lag": self.chosen.asymmetry is not None,
            "bent characteristic": self.chosen.slopes is not None,
            "actuator lag": self.evidence.actuator_lag > 0.0,
            "break-away": self.chosen.break_away is not None,
        }
        return tuple(name for name, there in needed.items() if there)

    @property
    def _predictor(self) -> Predictor:
        return replace(super()._predictor, still=self.chosen.break_away)

    @property
    @abstractmethod
    def facts(self) -> Any:
        """What others need to know of the fit, without its signals: a ``FitFacts``, which lies above this module."""

    @abstractmethod
    def to_dict(self) -> dict[str, Any]:
        """JSON-ready description."""

    @property
    def kind(self) -> Kind:
        """All that is known of the kind of the actuator that was fitted."""
        return kind_of(self.nonlinearity.kind)

    @property
    def preferred(self) -> str:
        """What the record supports: this kind or a likelier one, "none" (linear does as well), or "cannot tell".

        A linear model whose errors depend on OP has not shown that there is no fault, nor one of a record in which PV
        answers nothing that is new in OP, or OP foretells PV (`evidence.can_exclude`).
        """
        if self.status is Status.NOT_SEEN:
            return "none" if self.evidence.can_exclude else "cannot tell"
        if self.kind.name == NO_FAULT and (self.status is Status.MISFIT or not self.evidence.can_exclude):
            return "cannot tell"
        if self.status is Status.OTHER_KIND and self.evidence.other_kind is not None:
            return self.evidence.other_kind[0]
        return self.nonlinearity.kind if self.status.ok or self.status in SEEN else "cannot tell"

    @property
    def found_in_words(self) -> str:
        """Kind that the record supports, with the interval of its size."""
        size = self.shown_size
        return self.preferred if size is None else f"{self.preferred} {between(*self.size_interval)}"

    @property
    def message(self) -> str:
        """Sentence of the status; where a linear model is OK or another kind is seen it has its own."""
        other = self.evidence.other_kind
        if self.status is Status.OTHER_KIND and other is not None:
            advice = "" if self.kinds else "; use nonlinearity='auto'"
            return f"Converged, but the record shows {other[0]} rather than {self.kind.name}{advice}."
        if self.status is not Status.OK or self.kind.name != NO_FAULT:
            return self.status.value
        if self.kinds is None:
            return f"{LINEAR}; lost motion was not searched."
        seen = "and shows no lost motion" if self.preferred == NO_FAULT else "which neither shows nor excludes one"
        return f"{LINEAR}, {seen}."

    @property
    def shown_size(self) -> str | None:
        """Parameter that is the size of the lost motion which the record shows; None where it shows no size."""
        return self.kind.size if self.preferred == self.kind.name and self.status is not Status.WIDE else None

    def interval(self, name: str, level: float = 0.95) -> tuple[float, float]:
        """Confidence interval of a parameter.

        Parameters
        ----------
        name : str
            Key of `parameters`.
        level : float
            Confidence in (0, 1).

        Returns
        -------
        (float, float)
            Lower and upper end, on a logarithmic scale for slopes. Where no dead zone is seen its break points
            and slope ratio can be anywhere, so their interval is the whole line; that of the width begins at 0, and has
            no end where the record excludes none (`evidence.can_exclude`).
            Other dead zones that fit about as well (`evidence.rivals`, less than 6 of BIC behind) lie inside.
            That of a size is wider by what OP does between the rows (`evidence.unseen_moves`).

        Raises
        ------
        ParameterError
            Unknown name or a level outside (0, 1).
        """
        return self._interval(name, level, self.evidence.unseen_moves)

    @property
    def size_interval(self) -> tuple[float, float]:
        """95 % interval of the size of the lost motion, in units of OP: the one that every report shows.

        :meth:`interval` is statistical: it holds if the valve is what the model is. Of a valve that sticks this one
        counts as well what friction is and a play with a jump is not: 5 % of the size to either side, and more where
        the valve slips between the rows of a loop at rest. (nan, nan) of a kind without a size.
        """
        name = self.kind.size
        if name is None:
            return np.nan, np.nan
        slips = slips_at_rest(self.nonlinearity, self.evidence)
        return with_model_error(self.interval(name), self.parameters[name], self.kind, slips)

    def _interval(self, name: str, level: float, moves: float) -> tuple[float, float]:
        """Interval of a parameter, where OP moves so between the rows."""
        low, high = super().interval(name, level)
        if name in self.profiled:  # asymmetric; other levels in proportion
            share = normal_quantile(0.5 + level / 2) / normal_quantile(0.975)
            value, ends = self.parameters[name], self.profiled[name]
            low, high = value - share * (value - ends[0]), value + share * (ends[1] - value)
        low, high = self._with_rivals(name, low, high)
        if name == self.kind.size:
            sticks = self.kind.sticks
            low, high = within_unseen(low, moves, sticks), beyond_unseen(high, moves, sticks)
        if name == "width":
            low = max(low, 0.0)
        if name in POSITIVE and self.parameters[name] > 0:
            with np.errstate(over="ignore"):
                factor = np.exp((high - low) / (2.0 * self.parameters[name]))
            low, high = self.parameters[name] / factor, self.parameters[name] * factor
        if self.status in HIDDEN:
            if name == self.kind.size:
                if not self.evidence.can_exclude:
                    return 0.0, np.inf
                return 0.0, max(high, 0.0) if self.widest is None else self.widest
            if name in self.kind.anywhere:
                return -np.inf, np.inf
        if self.status is Status.ONE_SIDED and name in self.unvisited:
            return (0.0, np.inf) if name == "width" else (-np.inf, np.inf)
        return low, high

    def _with_rivals(self, name: str, low: float, high: float) -> tuple[float, float]:
        """Interval that holds the other dead zones which fit about as well."""
        for left, right, behind in self.evidence.rivals:
            other = {"left": left, "right": right, "width": right - left}
            if behind < EVEN_ODDS and name in other:
                low, high = min(low, other[name]), max(high, other[name])
        return low, high

    @property
    def unvisited(self) -> tuple[str, ...]:
        """Parameters of a side on which OP has hardly been (status ONE_SIDED), and what hangs on them."""
        return self.kind.unvisited(self.evidence) if self.status is Status.ONE_SIDED else ()

    def summary(self) -> Summary:
        """Report as text, with as many digits as the standard errors allow."""
        return Summary(_verbs.text(self), self)

    def compensator(self, **options: Any) -> Any:
        """Ideal inverse of the dead zone or backlash; see :func:`lostmotion.compensate.compensator_from_fit`.

        What is fit for a PLC, with the uncertainty of this fit in its settings, is :meth:`block`.
        """
        return _verbs.compensator(self, **options)

    def block(self, **options: Any) -> Any:
        """Compensating block with safeguards; see :func:`lostmotion.compensate.block_from_fit`."""
        return _verbs.block(self, **options)

    def save(self, path: str | os.PathLike[str], force: bool = False) -> Path:
        """Write :meth:`to_dict` as JSON, whole or not at all; :func:`lostmotion.read_fit` reads it.

        Raises
        ------
        FileAccessError
            The file exists and `force` is not set, or the folder cannot be written.
        """
        return write_json(path, self.to_dict(), force)

    def __str__(self) -> str:
        return self.summary()
