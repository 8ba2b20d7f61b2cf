"""One row for each loop: truth, verdict, features."""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[_name] = "1"  # before NumPy is imported, also in workers

import time  # noqa: E402
from dataclasses import dataclass, field, replace  # noqa: E402
from typing import Any  # noqa: E402

import lostmotion as lm  # noqa: E402
from lostmotion.evaluate import random_faulty_loop  # noqa: E402
from lostmotion.evaluate.random_faults import FaultyLoop  # noqa: E402
from verdicts.second_family import second_family  # noqa: E402
from verdicts.truth import told  # noqa: E402

SAMPLES = 2000
GLUED_AT = 846  # row at which the second recording of tuning-L-paper-horch begins


@dataclass(frozen=True)
class Row:
    """One loop.

    Attributes
    ----------
    name, truth, source : str
        `truth` is a cause of ``random_faults`` or the label of a real loop.
    verdict, kind : str
        "refused" where the record was.
    width, found : float
        True and found size; NaN where there is none.
    gains, likelihoods : dict of float
        Of the kinds, as in ``KindChoice``.
    told : bool
        Of a visible fault: a search that is told the answer finds it (see ``truth.told``).
    loop, contributor : str
        Of a real record: its physical loop, and who gave it.
    """

    name: str
    truth: str
    source: str
    verdict: str
    kind: str
    confidence: float
    probabilities: dict[str, float]
    features: tuple[float, ...]
    visible: bool
    width: float
    noise_in_op: float
    found: float
    severity: float
    seconds: float
    reason: str = ""
    gains: dict[str, float] = field(default_factory=dict)
    likelihoods: dict[str, float] = field(default_factory=dict)
    told: bool = False
    loop: str = ""
    contributor: str = ""


def rough(seed: int) -> Row:
    """The same with steps of load and noise with long tails."""
    return simulated(seed, rough=True)


def second(seed: int) -> Row:
    """A loop of the second family."""
    return _of_loop(seed, second_family(seed))


def for_calibration(seed: int) -> Row:
    """Every second loop a rough one; without asking what a record tells."""
    return _of_loop(seed, random_faulty_loop(seed, SAMPLES, rough=bool(seed % 2)), ask=False)


def simulated(seed: int, *, rough: bool = False) -> Row:
    """A random loop of known fault."""
    return _of_loop(seed, random_faulty_loop(seed, SAMPLES, rough=rough))


def _of_loop(seed: int, loop: FaultyLoop, ask: bool = True) -> Row:
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=loop.dt, op_span=(0.0, 100.0))
    row = _row(str(seed), loop.cause, loop.process, record, {}, loop.visible, loop.width, loop.noise_in_op)
    asked = ask and loop.visible and row.verdict != "refused" and loop.actuator.kind != "none"
    return replace(row, told=asked and told(loop))


def real(name: str, label: str, source: str, path: Any, options: dict[str, Any], known: dict[str, Any]) -> Row:
    """A real loop with the label of its contributor."""
    try:
        record = lm.read_loop(path, **options)
        if name.startswith("tuning-L-paper-horch"):
            record = record.cut(0, GLUED_AT)
    except lm.InputError as refused:
        return _refused(name, label, source, str(refused))
    return _row(name, label, source, record, known, True, float("nan"), float("nan"))


def _row(
    name: str,
    truth: str,
    source: str,
    record: lm.LoopRecord,
    known: dict[str, Any],
    visible: bool,
    width: float,
    noise_in_op: float,
) -> Row:
    begun = time.process_time()
    try:
        found = lm.diagnose(record, **known)
    except lm.InputError as refused:
        return _refused(name, truth, source, str(refused))
    seconds = time.process_time() - begun
    kinds = found.fit.kinds
    gains, likelihoods = ({}, {}) if kinds is None else (kinds.gains, kinds.likelihoods)
    return Row(
        name, truth, source, found.verdict, found.kind, found.confidence, found.probabilities,
        tuple(found.measured.features.values().tolist()), visible, width, noise_in_op, found.size,
        found.size_percent, seconds, gains=gains, likelihoods=likelihoods,
    )  # fmt: skip


def _refused(name: str, truth: str, source: str, reason: str) -> Row:
    nan = float("nan")
    return Row(name, truth, source, "refused", "unknown", 0.0, {}, (), False, nan, nan, nan, nan, 0.0, reason)
