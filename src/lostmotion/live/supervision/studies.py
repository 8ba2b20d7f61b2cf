"""The study that a request has to pass, in a process of its own: neither link nor estimators wait for it."""

from __future__ import annotations

import multiprocessing
import signal
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

from lostmotion.compensate import CompensatorBlock
from lostmotion.compensate.derive import block_from_fit
from lostmotion.errors import GateError, LostMotionError
from lostmotion.evaluate import CompensationStudy, compensation_study
from lostmotion.identify import FitFacts, RecursiveEstimate
from lostmotion.live.supervision.settings import BlockSettings

LONGEST = 300.0  # s for a study, which takes some seconds
LEAVE = 2.0  # s for a process to end


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
        context = multiprocessing.get_context("spawn")  # never fork: there are threads
        self._answers, says = context.Pipe(duplex=False)
        self._process = context.Process(target=_answer, args=(says, work, given), daemon=True)
        self._process.start()
        says.close()
        self._begun = time.monotonic()

    @property
    def done(self) -> bool:
        """Whether :meth:`result` gives an answer."""
        return self._answers.poll() or time.monotonic() - self._begun > LONGEST

    def result(self) -> CompensationStudy:
        """What came of it, once.

        Raises
        ------
        LostMotionError
            As the work itself; or it died, or took too long.
        """
        try:
            if not self._answers.poll():
                raise GateError.expected(f"a study within {LONGEST:g} s", "none", "nothing is asked")
            answer = self._answers.recv()
        except EOFError as error:
            raise GateError.expected("a study", "a process that died", "nothing is asked") from error
        finally:
            self.close()
        if isinstance(answer, Exception):
            raise answer
        study: CompensationStudy = answer
        return study

    def close(self) -> None:
        """End it; harmless where that has been done."""
        self._process.terminate()
        self._process.join(LEAVE)
        self._answers.close()


def _answer(says: Any, work: Callable[..., CompensationStudy], given: tuple[Any, ...]) -> None:
    """In the new process: Ctrl-C is for the one that asked."""
    for name in ("SIGINT", "SIGHUP"):
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_IGN)
    answer: Any
    try:
        answer = work(*given)
    except LostMotionError as error:
        answer = type(error)(str(error))
    except Exception as error:  # noqa: BLE001  said where it was asked for
        answer = GateError.expected("a study", f"{type(error).__name__}: {error}", "tell us, with the fit")
    with suppress(OSError):  # nobody waits for it any more
        says.send(answer)
