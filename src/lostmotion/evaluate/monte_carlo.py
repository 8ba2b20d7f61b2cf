"""Monte Carlo over random loops: how often an estimator succeeds, how exact and how honest it is."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from lostmotion import _verbs
from lostmotion.arguments import whole
from lostmotion.arrays import FloatArray
from lostmotion.brief import Brief, counted
from lostmotion.errors import ParameterError
from lostmotion.evaluate.random_loops import SAMPLES, RandomLoop, random_loop
from lostmotion.evaluate.scores import BREAK_POINTS, GROUPS, CaseResult, Score, score
from lostmotion.evaluate.workers import Progress, run_all
from lostmotion.identify import identify
from lostmotion.summary import Summary

if TYPE_CHECKING:
    import polars as pl

Estimator = Callable[[FloatArray, FloatArray, float], Any]
PRESETS = {"small": 40, "large": 500}  # loops: for a look, and as in docs/family.md
NAMES = ("left", "right", "width", "slope_ratio")


@dataclass(frozen=True, eq=False, repr=False)
class MonteCarloResult(Brief):
    """Every case of a run, and its figures.

    Attributes
    ----------
    cases : tuple of CaseResult
        In the order of their index; ``random_loop(case.index, seed, samples)`` makes the record again.
    seed, samples : int
        Seed of the family and length of the records.
    """

    cases: tuple[CaseResult, ...]
    seed: int
    samples: int

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return counted(len(self.cases), "case"), f"seed {self.seed}", f"{self.samples} samples each"

    def score(self, group: str = "all") -> Score:
        """Figures of one group of cases; see :func:`lostmotion.evaluate.scores.score`.

        Raises
        ------
        ParameterError
            Unknown group.
        """
        if group not in GROUPS:
            raise ParameterError.expected(f"group as one of {list(GROUPS)}", repr(group), "see GROUPS")
        return score([case for case in self.cases if GROUPS[group](case)])

    @property
    def scores(self) -> dict[str, Score]:
        """Figures of all groups."""
        return {group: self.score(group) for group in GROUPS}

    @property
    def table(self) -> pl.DataFrame:
        """One row for each case."""
        import polars as pl  # noqa: PLC0415  only those who want a table wait for it

        return pl.DataFrame([case.row() for case in self.cases], infer_schema_length=None)

    def summary(self) -> Summary:
        """Table of the figures as text."""
        return Summary(_verbs.text(self), self)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready: figures and all cases; what is not finite becomes None."""
        cases = [_finite(asdict(case)) for case in self.cases]
        return {"seed": self.seed, "samples": self.samples, "scores": self.scores, "cases": cases}

    def __str__(self) -> str:
        return self.summary()


def monte_carlo(
    preset: str = "small",
    estimator: Estimator | None = None,
    seed: int = 0,
    workers: int | None = None,
    *,
    cases: int | None = None,
    samples: int = SAMPLES,
    progress: Progress | None = None,
) -> MonteCarloResult:
    """Run an estimator over a family of random loops whose truth is known.

    Parameters
    ----------
    preset : {"small", "large"}
        40 or 500 loops; the small ones are the first of the large ones.
    estimator : callable (u, y, dt) -> result, optional
        The result has the names of ``HammersteinFit``: `status`, `parameters`, `standard_errors`, `interval` and
        `linear`. None: ``identify`` with everything "auto". What it raises is kept as a failure. With several
        workers it must be a function of a module, so that processes can be handed it.
    seed : int
        Seed of the family.
    workers : int, optional
        Processes side by side; default: all cores.
    cases : int, optional
        Number of loops instead of the preset's.
    samples : int
        Length of each record.
    progress : callable (done, total), optional
        Called after each case; default: a bar on stderr where that is a terminal.

    Returns
    -------
    MonteCarloResult

    Raises
    ------
    ParameterError
        Unknown preset, fewer than one case, or fewer than 200 samples.

    Examples
    --------
    >>> def white(u, y, dt):
    ...     return identify(u, y, dt, nonlinearity="dead zone", orders=(1, 0, 1), noise="white")
    >>> result = monte_carlo(estimator=white, cases=2, samples=200, workers=1)
    >>> [case.error for case in result.cases]
    [None, None]
    """
    if preset not in PRESETS:
        raise ParameterError.expected(f"preset as one of {list(PRESETS)}", repr(preset), "or give cases=")
    count = PRESETS[preset] if cases is None else whole("cases", cases, 1)
    workers = None if workers is None else whole("workers", workers, 1)
    seed, samples = whole("seed", seed, 0), whole("samples", samples, 200)
    jobs = [(index, seed, samples, estimator) for index in range(count)]
    done = run_all(_one, jobs, "random loops", workers, progress)
    return MonteCarloResult(tuple(done), seed, samples)


def measure(loop: RandomLoop, estimator: Estimator) -> CaseResult:
    """Run the estimator on one loop and hold what it found beside the truth."""
    begin = time.process_time()
    try:
        fit = estimator(loop.u, loop.y, loop.dt)
        seconds = time.process_time() - begin
        outcome = _outcome(fit)
    except Exception as error:  # noqa: BLE001  any estimator may be measured; its failure is a result
        seconds = time.process_time() - begin
        outcome = _nothing(f"{type(error).__name__}: {error}")
    return CaseResult(
        index=loop.index,
        closed=loop.closed,
        coloured=loop.noise.order > 0,
        order=loop.orders[0],
        process=loop.process,
        delay=loop.orders[2],
        snr_db=loop.snr_db,
        share=loop.share,
        identifiable=loop.identifiable,
        delay_told=loop.delay_told,
        truth=loop.truth,
        expected=loop.expected,
        seconds=seconds,
        **outcome,
    )


def _outcome(fit: Any) -> dict[str, Any]:
    """What a fit says, as fields of a CaseResult. A fit without a dead zone has no interval: it can be anywhere."""
    found = {name: float(fit.parameters.get(name, math.nan)) for name in NAMES}
    intervals = {
        name: tuple(map(float, fit.interval(name))) if name in fit.parameters else (-math.inf, math.inf)
        for name in BREAK_POINTS
    }
    return {
        "found": found,
        "reported": {name: float(fit.standard_errors.get(name, math.nan)) for name in NAMES},
        "intervals": intervals,
        "status": str(fit.status.name),
        "usable": bool(fit.status.ok) and "left" in fit.parameters,
        "orders": (len(fit.linear.a), len(fit.linear.b) - 1),
        "delay_found": int(fit.linear.delay),
        "error": None,
    }


def _nothing(error: str) -> dict[str, Any]:
    unknown = dict.fromkeys(NAMES, math.nan)
    nowhere = dict.fromkeys(BREAK_POINTS, (math.nan, math.nan))
    return {
        "found": unknown, "reported": dict(unknown), "intervals": nowhere, "status": "ERROR", "usable": False,
        "orders": None, "delay_found": None, "error": error,
    }  # fmt: skip


def _one(job: tuple[int, int, int, Estimator | None]) -> CaseResult:
    index, seed, samples, estimator = job
    if estimator is None:
        _compiled()
    return measure(random_loop(index, seed, samples), identify if estimator is None else estimator)


@functools.cache
def _compiled() -> None:
    """Compile the kernels of ``identify``, once in each process, so that the first loop does not pay for it."""
    measure(random_loop(0, 0, 300), identify)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
