"""The study that a request has to pass, in a process of its own: neither link nor estimators wait for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.derive import block_from_fit
from lostmotion.errors import EngineError, GateError, LostMotionError
from lostmotion.evaluate import CompensationStudy, compensation_study
from lostmotion.identify import FitFacts, RecursiveEstimate
from lostmotion.live.supervision.settings import BlockSettings
from lostmotion.workers import Background, WorkerLateError
from lostmotion.workers.child import one_line

LONGEST = 300.0  # s for a study, which takes some seconds


def study_of_estimate(
    settings: BlockSettings, estimate: RecursiveEstimate, tried: CompensatorBlock
) -> CompensationStudy:
    """The block in the PLC with other widths, on the loop as the estimate in service sees it."""
    return compensation_study(estimate, settings.controller, block=tried, **settings.study)


def study_of_fit(settings: BlockSettings, fit: Mapping[str, Any]) -> CompensationStudy:
    """The block in the PLC with the widths that a fit gives, on the loop of the fit.

    Raises
    ------
    GateError
        The fit does not show the lost motion that the block is for.
    DataError, ParameterError
        It is no fit; or as :func:`lostmotion.compensation_study`.
    """
    facts = FitFacts.from_dict(fit)
    return compensation_study(facts, settings.controller, block=block_with_widths_of(settings, facts), **settings.study)


def block_with_widths_of(settings: BlockSettings, facts: FitFacts) -> CompensatorBlock:
    """The block as it was commissioned, but for the widths, and for a factor that is not above its own."""
    commissioned, specification = settings.block.block, settings.block.specification
    if facts.kind.name != specification.fault:
        got = f"a fit of a {facts.kind.name}"
        raise GateError.expected(f"a fit of a {specification.fault}, which the block is for", got, "fit this loop")
    method = "two moves" if commissioned.kind == "stiction two moves" else "knocker"
    least, most = facts.op_range
    span = (min(commissioned.settings["low"], least), max(commissioned.settings["high"], most))
    made = block_from_fit(facts, scan_time=commissioned.scan_time, span=span, method=method).settings
    widths = {name: made[name] for name in (specification.first, specification.second) if name}
    return commissioned.with_settings(factor=min(made["factor"], commissioned.settings["factor"]), **widths)


class Running:
    """A study under way; looked at, not waited for.

    Parameters
    ----------
    work : callable
        :func:`study_of_estimate` or :func:`study_of_fit`, which a new process can import.
    *given
        What it takes.
    """

    def __init__(self, work: Callable[..., CompensationStudy], *given: Any) -> None:
        self._call = Background(work, *given, seconds=LONGEST)

    @property
    def done(self) -> bool:
        """Whether :meth:`result` gives an answer."""
        return self._call.outcome is not None

    def result(self) -> CompensationStudy:
        """What came of it, once.

        Raises
        ------
        LostMotionError
            As the work itself; or it died, or took too long.
        """
        outcome = self._call.outcome
        self.close()
        error = None if outcome is None else outcome.error
        if outcome is None or isinstance(error, WorkerLateError):
            raise GateError.expected(f"a study within {LONGEST:g} s", "none", "nothing is asked")
        if isinstance(error, EngineError):
            raise GateError.expected("a study", "a process that died", "nothing is asked") from error
        if isinstance(error, LostMotionError):
            raise error
        if error is not None:
            raise GateError.expected("a study", one_line(error), "tell us, with the fit")
        study: CompensationStudy = outcome.value
        return study

    def close(self) -> None:
        """End it; harmless where that has been done."""
        self._call.close()
