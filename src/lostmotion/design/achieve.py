"""``achievable``: what the data at hand can at best give."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion import _verbs
from lostmotion.arguments import finite_signal
from lostmotion.arrays import FloatArray, IntArray
from lostmotion.brief import Brief
from lostmotion.compensate.gate import Said
from lostmotion.design.bound import half_widths
from lostmotion.design.plausible_plants import SPREAD
from lostmotion.design.prior import known
from lostmotion.design.simulated_plant import Plant
from lostmotion.errors import DataError, ParameterError
from lostmotion.identify import RatedEstimate
from lostmotion.identify.data import FEWEST_SAMPLES
from lostmotion.kernels.threads import one_thread
from lostmotion.models import Hammerstein, NoiseModel
from lostmotion.records import LoopRecord, RecordLike
from lostmotion.records.as_record import as_records
from lostmotion.summary import Summary

PLANTS = 16  # drawn: the worst of them is beyond 94 % of all plants in two of three cases


@dataclass(frozen=True, eq=False, repr=False)
class Achievable(Brief):
    """Best intervals that any unbiased estimator can get from given data. Frozen; prints and writes itself.

    Attributes
    ----------
    expected : dict of float
        Half-widths of the 95 % intervals if the model as given is true: left, right, width in units of OP,
        slope_ratio, gain. Infinite where the data are blind.
    expected_best, expected_worst : dict of float
        Smallest and largest over plausible plants.
    samples, duration, dt : int, seconds, seconds
    width : float
        Width of the dead zone of the model, in units of OP.
    beyond : (int, int, int)
        Samples of OP left of the dead zone, inside, right of it.
    sentence : str
        The answer in one sentence.
    feedback : bool
        Whether PV was used: coloured noise in closed loop, and a fit. Without, the bound is exact for white noise and
        in open loop, and a little too good for coloured noise in closed loop.
    settings : dict
    """

    expected: dict[str, float]
    expected_best: dict[str, float]
    expected_worst: dict[str, float]
    samples: int
    dt: float
    width: float
    beyond: tuple[int, int, int]
    feedback: bool
    settings: dict[str, Any]

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words."""
        return f"width {self.width:.4g} +-{self.expected['width']:.2g}", f"{self.samples} samples"

    @property
    def duration(self) -> float:
        """Seconds."""
        return self.samples * self.dt

    @property
    def sees(self) -> bool:
        """Whether a dead zone of the model's width could be told from none: an interval that leaves 0 out."""
        return bool(self.expected["width"] < self.width)

    @property
    def sentence(self) -> str:
        """The answer in one sentence."""
        reach = self.expected["width"]
        if not np.isfinite(reach):
            side = "left" if self.beyond[0] < self.beyond[2] else "right"
            blind = "on both sides" if not (self.beyond[0] or self.beyond[2]) else f"beyond the {side} break point"
            return f"These {self.samples} samples cannot give the width at all: OP is never {blind}."
        return (
            f"A record of {self.samples} samples like this one cannot give the width better than +-{reach:.2g} (95 %), "
            f"{100 * reach / self.width:.2g} % of the width."
        )

    def samples_for(self, half_width: float) -> float:
        """Samples of data like these that a half-width of the width takes; infinite where they are blind."""
        return self.samples * (self.expected["width"] / half_width) ** 2

    def summary(self) -> Summary:
        """Report as text."""
        return Summary(_verbs.text(self), self)

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready. Infinite numbers become None."""

        def clean(values: dict[str, float]) -> dict[str, float | None]:
            return {name: float(value) if np.isfinite(value) else None for name, value in values.items()}

        return {
            "sentence": self.sentence,
            "sees": self.sees,
            "samples": self.samples,
            "dt": self.dt,
            "duration_s": self.duration,
            "feedback": self.feedback,
            "width": self.width,
            "samples_left_inside_right": list(self.beyond),
            "expected_95": clean(self.expected),
            "expected_95_best": clean(self.expected_best),
            "expected_95_worst": clean(self.expected_worst),
            "settings": dict(self.settings),
        }

    def __str__(self) -> str:
        return self.summary()


@one_thread
def achievable(
    u: npt.ArrayLike | RecordLike | Sequence[RecordLike],
    model: Hammerstein | RatedEstimate | Mapping[str, Any],
    noise: NoiseModel | float | None = None,
    *,
    y: npt.ArrayLike | None = None,
    spread: float = SPREAD,
    seed: int = 0,
    diagnosis: Said | None = None,
    accept: str | None = None,
) -> Achievable:
    """What these data can at best tell: the Cramer-Rao bound of a rough model on this very input.

    Parameters
    ----------
    u : array_like (n,), LoopRecord, path, data frame, dict of columns or a list of these
        OP. A record brings its PV; gaps and missing samples cut it into pieces, each with an unknown initial state.
    model, noise, spread
        As in :func:`design`.
    y : array_like (n,), optional
        PV, with arrays only: for coloured noise in closed loop, beside a fit.
    seed : int
        Of the plausible plants.
    diagnosis, accept
        As in :func:`design`.

    Returns
    -------
    Achievable

    Raises
    ------
    ParameterError
        A sampling time that contradicts the model, or settings as in :func:`design`.
    DataError
        Missing samples in arrays, too few samples.

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> answer = lm.achievable(lm.signals.prs(2000, -5, 5, 10, seed=0), tank, 0.03)
    >>> print(answer.sentence)
    A record of 2000 samples like this one cannot give the width better than +-0.0088 (95 %), 0.44 % of the width.
    """
    rough = known(model, noise, spread, diagnosis, accept)
    op, pv, segments = _pieces(u, y, rough.model.linear.dt)
    given = Plant(rough.model, rough.noise, 0.0)
    # a guess does not follow PV closely enough to tell the noise in it, so PV is used with a fit only
    pv = pv if rough.covariance is not None and rough.noise.order else None
    plants = [given, *(replace(given, model=other) for other in rough.fresh(PLANTS, seed))]
    several = [half_widths(plant, op, pv if plant is given else None, segments) for plant in plants]
    own = several[0]
    left, right = int((op < given.zone.left).sum()), int((op > given.zone.right).sum())
    return Achievable(
        expected=own,
        expected_best={name: min(one.get(name, np.inf) for one in several) for name in own},
        expected_worst={name: max(one.get(name, np.inf) for one in several) for name in own},
        samples=op.size,
        dt=rough.model.linear.dt,
        width=given.zone.width,
        beyond=(left, op.size - left - right, right),
        feedback=pv is not None,
        settings={
            "plants": len(several),
            "roughness": rough.roughness,
            "pieces": len(segments),
            **({"accepted": rough.accepted} if rough.accepted else {}),
        },
    )


def _pieces(u: Any, y: npt.ArrayLike | None, dt: float) -> tuple[FloatArray, FloatArray | None, IntArray]:
    """OP, PV (None where not given) and the segments."""
    u = as_records(u) if y is None else u
    records = [u] if isinstance(u, LoopRecord) else u
    if not (isinstance(records, list | tuple) and records and isinstance(records[0], LoopRecord)):
        op = finite_signal("u", u)
        pv = None if y is None else finite_signal("y", y, op.size)
        whole = np.array([[0, op.size]])
        _check_samples(op.size)
        return op, pv, whole
    if y is not None:
        raise ParameterError.expected("records alone", "records and y", "a record has its PV")
    for record in records:
        if abs(record.dt - dt) > 1e-6 * dt:
            raise ParameterError.expected(f"a record with dt={dt:g} as the model", f"{record.dt:g}", "resample one")
    pieces = [piece for record in records for piece in record.split(FEWEST_SAMPLES)]
    _check_samples(sum(len(piece) for piece in pieces))
    stops = np.cumsum([len(piece) for piece in pieces])
    segments = np.column_stack([np.concatenate([[0], stops[:-1]]), stops]).astype(np.int64)
    return np.concatenate([piece.op for piece in pieces]), np.concatenate([piece.pv for piece in pieces]), segments


def _check_samples(samples: int) -> None:
    if samples < FEWEST_SAMPLES:
        raise DataError.expected(f"{FEWEST_SAMPLES} samples without a gap", samples, "use a longer record")
