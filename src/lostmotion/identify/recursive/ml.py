"""RecursiveML: recursive maximum likelihood of the whole Hammerstein model, started from a batch fit."""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from dataclasses import asdict
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lostmotion.arguments import finite, positive, signal, whole
from lostmotion.arrays import FloatArray
from lostmotion.distributions import normal_quantile
from lostmotion.errors import DataError, ParameterError, Status
from lostmotion.identify.actuators.dead_zone import DeadZoneFamily
from lostmotion.identify.likelihood.offset import without_column
from lostmotion.identify.likelihood.parameters import information_inverse, named_values
from lostmotion.identify.recursive.change import NEVER, ChangeEvent, Memory, forget, react, relinearise
from lostmotion.identify.recursive.estimate import RecursiveEstimate, Trajectory
from lostmotion.identify.recursive.ml_start import (
    GOOD,
    Tuning,
    Window,
    allocate,
    fit_window,
    is_anchored,
    is_clear,
    start,
)
from lostmotion.identify.scaled import Scaling
from lostmotion.kernels import recursive_ml as kernel
from lostmotion.kernels.threads import one_thread
from lostmotion.models import DeadZone, Hammerstein, Identity, LinearModel, NoiseModel, Nonlinearity

MOST_EVENTS = 100
LARGEST_WINDOW = 8  # times the first window: how long a start may wait for information
UNSEEN_WINDOW = 4  # times the first window: that there is no dead zone is believed later than a dead zone
FORMAT = "lostmotion recursive ml 1"
NAMES = ("left", "right", "left_slope", "right_slope")
_RUN: Any = kernel.run
_ONE: Any = kernel.one
_BROKEN = (ValueError, OSError, KeyError, EOFError, TypeError, IndexError, zipfile.BadZipFile, zlib.error)


class RecursiveML:
    """Recursive maximum likelihood (prediction error) of dead zone, process, offset and AR noise.

    A first window is fitted in batch. After it every sample adds its linearised equation to an information matrix,
    and the estimate is the solution of all that is remembered: as accurate as the batch fit of all samples, at the
    cost of a few filters per sample. A change of a break point raises an event, and what it made wrong is forgotten.

    Parameters
    ----------
    na, nb, delay : int
        Orders and delay of the linear part, as in ``identify``.
    gain : float or None
        Known static gain of the linear part (paper, eq 25). None: right_slope = 1.
    forgetting : float
        In (0.95, 1]. The memory is 1 / (1 - forgetting) samples. It is forgotten only as fast as new information
        comes in, direction by direction, so without excitation nothing is lost.
    dt : float
        Sampling time in seconds, for the linear model.
    noise : "auto", "white" or int
        Order of the AR output noise; "auto": as the batch fit of the first window finds it.
    offset : {"auto", "free", "zero"}
        Output at rest inside the dead zone, as in ``identify``. It is always estimated; "auto" reports the estimate
        with offset zero while the information criterion prefers it.
    start_samples : int
        Samples of the first window. Where it tells nothing or little, twice, four and eight times as many are tried.
    outliers : float or None
        Prediction errors beyond so many standard deviations have bounded influence (Huber); None: they count fully.
    false_alarms : float or None
        Accepted false events per sample; None: no test for changes.

    Notes
    -----
    Missing samples are NaN; they, masked samples (``use=False``) and the time that the process needs to forget an
    unknown command after them add no information. The state does not grow; results do not depend on how the stream
    is cut. Method: Ljung and Soderstrom, *Theory and Practice of Recursive Identification* (1983), sections 3.7 and
    5; test: Basseville and Nikiforov, *Detection of Abrupt Changes* (1993), chapter 8.

    Integrating processes are not followed: give the differences of PV instead, one order less. A window whose batch
    fit is integrating does not start the recursion.

    A width is claimed (Status.OK) where BIC prefers it to none, not from 1.96 standard errors on: the estimate is
    looked at again and again.

    Standard errors take the remembered information at full weight. With forgetting below 1 they are therefore wider
    than the noise alone would ask for (by up to the square root of two), which leaves room for the drift for whose
    sake one forgets.

    Examples
    --------
    >>> import lostmotion as lm
    >>> tank = lm.platforms.level_tank()
    >>> u = lm.signals.prs(20_000, -5, 5, hold=10, seed=0)
    >>> y = tank.simulate(u) + np.random.default_rng(0).normal(scale=0.03**0.5, size=u.size)
    >>> rml = lm.RecursiveML(na=3, nb=2, delay=3, gain=2.2222)
    >>> trajectory = rml.run(u, y)
    >>> abs(rml.estimate.parameters["right"] - 1.0) < 0.005
    True
    """

    def __init__(
        self,
        na: int,
        nb: int,
        delay: int,
        gain: float | None = None,
        forgetting: float = 1.0,
        *,
        dt: float = 1.0,
        noise: str | int = "auto",
        offset: str = "auto",
        start_samples: int = 1000,
        outliers: float | None = 4.0,
        false_alarms: float | None = 1e-9,
    ) -> None:
        na, nb, delay = whole("na", na, 0), whole("nb", nb, 0), whole("delay", delay, 0)
        if not 0.95 < finite("forgetting", forgetting) <= 1:
            raise ParameterError.expected("forgetting in (0.95, 1]", forgetting, "0.999 remembers 1,000 samples")
        gain = None if gain is None else finite("gain", gain)
        if gain == 0:
            raise ParameterError.expected("a gain other than 0", gain, "give y per x at rest, or None")
        if not isinstance(offset, str) or offset not in ("auto", "free", "zero"):
            raise ParameterError.expected('offset as "auto", "free" or "zero"', repr(offset), "see the docstring")
        if not (isinstance(noise, str) and noise in ("auto", "white")):
            noise = whole('noise (or "auto", "white")', noise, 0)
        fewest = 4 * (na + nb + delay) + 60
        if whole("start_samples", start_samples, 1) < fewest:
            raise ParameterError.expected(f"start_samples >= {fewest} for these orders", start_samples, "1000 is usual")
        outliers = None if outliers is None else finite("outliers", outliers)
        if outliers is not None and outliers <= 1:
            raise ParameterError.expected("outliers > 1 (standard deviations) or None", outliers, "4 is usual")
        false_alarms = None if false_alarms is None else finite("false_alarms", false_alarms)
        if false_alarms is not None and not 0 < false_alarms < 0.01:
            raise ParameterError.expected("false_alarms in (0, 0.01) per sample, or None", false_alarms, "e.g. 1e-9")
        self._settings: dict[str, Any] = {
            "na": na, "nb": nb, "delay": delay, "gain": gain, "forgetting": float(forgetting),
            "dt": positive("dt", dt), "noise": noise, "offset": offset, "start_samples": int(start_samples),
            "outliers": outliers, "false_alarms": false_alarms,
        }  # fmt: skip
        self._begin()

    def _begin(self) -> None:
        settings = self._settings
        self._gathered: tuple[list[float], list[float]] = ([], [])  # u and y of the first window
        self._seen = 0  # samples before the recursion has begun
        self._next_try = int(settings["start_samples"])
        self._state: FloatArray | None = None
        self._layout: npt.NDArray[np.int64] = np.zeros(0, dtype=np.int64)
        self._psi: FloatArray = np.zeros(0)
        self._scales = (1.0, 1.0)
        self._events: list[ChangeEvent] = []
        clip, alarms = settings["outliers"], settings["false_alarms"]
        tuning = Tuning(settings["forgetting"], np.inf if clip is None else float(clip), np.inf, settings["offset"])
        if alarms is not None:
            block, ring, _ = tuning.memory
            tests = 3 * (int(math.log2(ring)) + 1)  # Bonferroni over directions and windows of one block
            threshold = -normal_quantile(0.5 * alarms * block / tests)
            tuning = Tuning(tuning.forgetting, tuning.clip, threshold, tuning.offset)
        self._tuning = tuning

    @property
    def samples(self) -> int:
        """Samples seen, missing ones included."""
        return self._seen if self._state is None else int(self._layout[kernel.COUNT]) + self._seen

    @property
    def started(self) -> bool:
        """Whether the first window has been fitted."""
        return self._state is not None

    @property
    def dt(self) -> float:
        """Sampling time in seconds."""
        return float(self._settings["dt"])

    @property
    def events(self) -> tuple[ChangeEvent, ...]:
        """The last changes, oldest first, 100 at most."""
        return tuple(self._events)

    def update(self, u: float, y: float, use: bool = True) -> float:
        """Take one sample; return its prediction error, NaN where there is none.

        Parameters
        ----------
        u, y : float
            Command and measurement; NaN: missing.
        use : bool
            False where the sample must not be learned from: manual mode with an unknown command, saturation.

        Raises
        ------
        DataError
            u or y is infinite or no number; nothing has changed then.
        """
        try:
            u, y = float(u), float(y)
        except (TypeError, ValueError, OverflowError) as broken:
            raise DataError.expected(
                "numbers u and y", f"u={u!r}, y={y!r}", "give NaN for a missing sample"
            ) from broken
        if math.isinf(u) or math.isinf(y):
            raise DataError.expected("finite u and y", f"u={u}, y={y}", "give NaN for a missing sample")
        if self._state is None:
            return self._collect(u, y, use)
        scale_u, scale_y = self._scales
        error, reason = _ONE(u / scale_u, y / scale_y, bool(use), self._state, self._layout, self._psi)
        if reason:
            self._look(reason)
        return float(error) * scale_y

    def run(self, u: npt.ArrayLike, y: npt.ArrayLike, every: int = 1, use: npt.ArrayLike | None = None) -> Trajectory:
        """Take all samples; keep every `every`-th estimate.

        Parameters
        ----------
        u, y : array_like, shape (n,)
            Command and measurement; NaN: missing.
        every : int
            Distance of the rows of the trajectory.
        use : array_like of bool, shape (n,), optional
            False where a sample must not be learned from.
        """
        u, y, mask = self._check(u, y, use)
        every = min(whole("every", every, 1), u.size + 1)
        begin = self.samples
        errors = np.full(u.size, np.nan)
        rows: list[FloatArray] = []
        at = 0
        while at < u.size and self._state is None:
            errors[at] = self._collect(float(u[at]), float(y[at]), bool(mask[at]))
            at += 1
        waited = at // every  # rows before there is an estimate
        if self._state is not None:
            n = int(self._layout[kernel.N])
            trace = np.empty((u.size // every, n))
            scaled_u, scaled_y = u / self._scales[0], y / self._scales[1]
            late = np.empty(u.size)
            first = at
            while at < u.size:
                at, reason = _RUN(scaled_u, scaled_y, mask, at, self._state, self._layout, late, every, trace)
                if reason:
                    self._look(reason)
            errors[first:] = late[first:] * self._scales[1]
            rows = list(trace[waited:])
        return self._trajectory(begin + every * np.arange(1, u.size // every + 1), waited, np.array(rows), errors)

    @staticmethod
    def _check(
        u: npt.ArrayLike, y: npt.ArrayLike, use: npt.ArrayLike | None
    ) -> tuple[FloatArray, FloatArray, npt.NDArray[np.bool_]]:
        u, y = signal("u", u), signal("y", y)
        try:
            mask = np.ones(u.size, dtype=bool) if use is None else np.array(use, dtype=bool, order="C")
        except ValueError as broken:
            raise DataError.expected("use as one bool a sample", repr(use)[:60], "make it an array") from broken
        if not u.shape == y.shape == mask.shape:
            raise DataError.expected(
                "u, y and use of one length", f"{u.shape}, {y.shape} and {mask.shape}", "cut them to the same rows"
            )
        for name, values in (("u", u), ("y", y)):
            if np.isinf(values).any():
                row = int(np.flatnonzero(np.isinf(values))[0])
                raise DataError.expected(
                    f"finite {name}", f"{values[row]} in row {row}", "give NaN for a missing sample"
                )
        return u, y, mask

    def _collect(self, u: float, y: float, use: bool) -> float:
        """Gather the first window; begin when it tells something."""
        self._gathered[0].append(u if use else math.nan)
        self._gathered[1].append(y if use else math.nan)
        self._seen += 1
        if self._seen >= self._next_try:
            self._try_to_start()
        return math.nan

    @one_thread
    def _try_to_start(self) -> None:
        settings = self._settings
        window = Window(np.array(self._gathered[0]), np.array(self._gathered[1]))
        first = settings["start_samples"]
        fit = fit_window(
            window, (settings["na"], settings["nb"], settings["delay"]), settings["noise"], settings["offset"],
            settings["dt"],
        )  # fmt: skip
        longest = self._seen >= LARGEST_WINDOW * first
        accepted = (*GOOD, Status.NOT_SEEN) if self._seen >= UNSEEN_WINDOW * first else GOOD
        if longest:
            accepted = (*accepted, Status.ONE_SIDED)
        integrating = fit is not None and fit.chosen.integrating
        clear = fit is not None and (self._seen >= 2 * first or is_clear(fit))
        anchored = fit is not None and (longest or is_anchored(fit))
        if fit is not None and fit.status in accepted and clear and anchored and not integrating:
            good = np.isfinite(window.u) & np.isfinite(window.y)
            self._scales = (float(window.u[good].std()), float(window.y[good].std()))
            self._state, self._layout = start(fit, window, self._scales, self._tuning)
            self._psi = np.zeros(int(self._layout[kernel.N]))
            self._seen -= window.u.size  # the recursion counts its window
            self._gathered = ([], [])
            return
        if longest:  # keep the newer half and go on waiting
            half = len(self._gathered[0]) // 2
            self._gathered = (self._gathered[0][half:], self._gathered[1][half:])
            self._next_try = self._seen + half
        else:
            self._next_try = 2 * self._seen

    @one_thread
    def _look(self, reason: int) -> None:
        """What the kernel cannot decide: explain an alarm, or fit the samples since a change again."""
        assert self._state is not None  # noqa: S101
        if reason == kernel.REFIT:
            relinearise(self._state, self._layout)
            return
        found = react(self._state, self._layout)
        if found is None:
            return
        kind, before, after, covariance, since = found
        names = {"both": ["left", "right"], "all": ["process", "left", "right"]}
        old, _ = self._tested(before)
        new, jacobian = self._tested(after)
        spread = np.sqrt(np.maximum(np.einsum("ij,jk,ik->i", jacobian, covariance, jacobian), 0.0))
        for name in names.get(kind, [kind]):
            i = ("left", "right", "process", "offset").index(name)
            event = ChangeEvent(self.samples, since + self._seen, name, old[i], new[i], float(spread[i]))
            self._events = [*self._events, event][-MOST_EVENTS:]

    def _tested(self, theta: FloatArray) -> tuple[list[float], FloatArray]:
        """Left, right, static gain from OP to PV beyond right, and offset, with their derivatives."""
        settings = self._settings
        scaling = Scaling(0.0, self._scales[0], 0.0, self._scales[1])
        values, jacobian = named_values(theta, DeadZoneFamily, settings["na"], settings["nb"], scaling, None)
        names = list(values)
        wanted = ("left", "right", "gain", "offset")
        return [values[name] for name in wanted], jacobian[[names.index(name) for name in wanted]]

    def reset(self, names: tuple[str, ...] = ("left", "right")) -> None:
        """Forget what is known about some parameters, as after a repair; the rest is kept.

        Parameters
        ----------
        names : tuple of str
            "left", "right", "slope_ratio", "process" (a, b and offset), "noise".
        """
        if self._state is None:
            self._begin()
            return
        memory = Memory(self._state, self._layout)
        eta = memory.eta
        places = {"left": [eta], "right": [eta + 1], "slope_ratio": [eta + 2], "process": list(range(eta))}
        places["noise"] = list(range(eta + 3, memory.n))
        for name in names:
            if name not in places:
                raise ParameterError.expected(f"names out of {list(places)}", repr(name), "see the docstring")
        chosen = sorted({index for name in names for index in places[name]})
        weak = memory.variance / np.maximum(1.0, np.abs(memory.theta)) ** 2
        left = forget(memory.older_than(0), chosen, weak)
        memory.part(kernel.REF_H, memory.n, memory.n)[:] = left.h
        memory.part(kernel.REF_R, memory.n)[:] = left.h @ left.centre
        memory.part(kernel.RING_H, memory.ring * memory.n**2)[:] = 0.0
        memory.part(kernel.RING_R, memory.ring * memory.n)[:] = 0.0
        memory.part(kernel.SUM_H, memory.n**2)[:] = 0.0  # samples from before in the open block
        memory.part(kernel.SUM_G, memory.n)[:] = 0.0
        self._layout[kernel.EXPLAIN_AT], self._layout[kernel.REFIT_AT] = 0, NEVER  # neither looks back beyond it
        self._layout[kernel.SINCE] = self._layout[kernel.COUNT]
        kernel.newton_step(self._state, self._layout)

    @property
    def estimate(self) -> RecursiveEstimate:
        """Present estimate with standard errors; CANNOT_TELL while the first window fills."""
        settings = self._settings
        if self._state is None:
            linear = LinearModel((0.0,) * settings["na"], (0.0,) * (settings["nb"] + 1), settings["delay"], self.dt)
            unknown = dict.fromkeys((*NAMES, "width", "slope_ratio", "gain", "offset"), math.nan)
            covariance = np.full((len(unknown),) * 2, np.inf)
            model = Hammerstein(Identity(), linear)
            return RecursiveEstimate(Status.CANNOT_TELL, model, unknown, covariance, self.samples)
        memory = Memory(self._state, self._layout)
        shown = memory.part(kernel.SHOWN, memory.n)
        basis = without_column(memory.n, memory.eta - 1) if kernel.pinned(self._state, self._layout) else None
        inverse, empty = information_inverse(memory.part(kernel.TOTAL_H, memory.n, memory.n), basis)
        values, jacobian, wrong = self._named(shown)
        covariance = jacobian @ (memory.variance * inverse) @ jacobian.T
        for direction in empty.T:
            move = jacobian @ direction
            lost = np.abs(move) > 1e-6 * np.abs(move).max(initial=1e-300)
            covariance[lost, lost] = np.inf
        d = shown[memory.eta + 3 :]
        noise = NoiseModel(tuple(d.tolist()), memory.variance * self._scales[1] ** 2)
        status = Status.WRONG_GAIN if wrong else self._status(values, covariance, memory)
        informed = {name: int(self._layout[kernel.LEFT_AT + i]) + self._seen for i, name in enumerate(NAMES[:2])}
        return RecursiveEstimate(status, self._model(values), values, covariance, self.samples, noise, informed)

    def _named(self, theta: FloatArray) -> tuple[dict[str, float], FloatArray, bool]:
        """Named parameters, their derivatives, and whether the known gain has the wrong sign."""
        settings, scaling = self._settings, Scaling(0.0, self._scales[0], 0.0, self._scales[1])
        na, nb = settings["na"], settings["nb"]
        try:
            return (*named_values(theta, DeadZoneFamily, na, nb, scaling, settings["gain"]), False)
        except ParameterError:
            return (*named_values(theta, DeadZoneFamily, na, nb, scaling, None), True)

    def _status(self, values: dict[str, float], covariance: FloatArray, memory: Memory) -> Status:
        errors = dict(zip(values, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True))
        reach = 0.25 * (memory.state[kernel.HIGH] - memory.state[kernel.LOW]) * self._scales[0]
        known = [errors[name] < reach for name in ("left", "right")]
        if not any(known):
            return Status.CANNOT_TELL
        if not all(known):
            return Status.ONE_SIDED
        # BIC of the one parameter: an estimate is looked at a thousand times, and 1.96 would claim a width by chance
        remembered = min(float(self.samples), 1.0 / max(1.0 - self._settings["forgetting"], 1e-12))
        return Status.OK if values["width"] ** 2 > np.log(remembered) * errors["width"] ** 2 else Status.NOT_SEEN

    def _model(self, values: dict[str, float]) -> Hammerstein:
        settings = self._settings
        zone: Nonlinearity = DeadZone(*(values[name] for name in NAMES))
        a = tuple(values[f"a{i + 1}"] for i in range(settings["na"]))
        b = tuple(values[f"b{i}"] for i in range(settings["nb"] + 1))
        return Hammerstein(zone, LinearModel(a, b, settings["delay"], self.dt), values["offset"])

    def _trajectory(
        self, samples: npt.NDArray[np.int64], waited: int, rows: FloatArray, errors: FloatArray
    ) -> Trajectory:
        settings, (scale_u, scale_y) = self._settings, self._scales
        na, nb1 = settings["na"], settings["nb"] + 1
        order = settings["noise"] if isinstance(settings["noise"], int) else 0
        n = len(self._psi) or na + nb1 + 4 + order
        theta = np.full((samples.size, n), np.nan)
        if len(rows):
            theta[waited:] = rows
        eta = na + nb1 + 1
        ratio = np.exp(theta[:, eta + 2])
        slope = np.ones(samples.size)
        if settings["gain"] is not None:
            product = theta[:, na : na + nb1].sum(axis=1) / (1.0 + theta[:, :na].sum(axis=1)) * scale_y / scale_u
            slope = np.where(product / settings["gain"] > 0, product / settings["gain"], 1.0)
        values = {"left": theta[:, eta] * scale_u, "right": theta[:, eta + 1] * scale_u}
        values |= {"left_slope": ratio * slope, "right_slope": slope + 0.0 * ratio, "theta": theta}
        return Trajectory(samples, values, errors)

    def period(self) -> tuple[dict[str, float], dict[str, float], int] | None:
        """Break points and width from the samples since the last call alone, for trends; begins a new period.

        Returns
        -------
        (values, standard errors, samples) or None
            From these samples alone: all other parameters are estimated anew with them, since what is known of them
            from before would make the periods depend on each other and their errors look too small. None: a break
            point is not known to a quarter of the range of u.
        """
        if self._state is None:
            return None
        memory = Memory(self._state, self._layout)
        h, r = memory.part(kernel.PERIOD_H, memory.n, memory.n), memory.part(kernel.PERIOD_R, memory.n)
        count = int(self._layout[kernel.COUNT] - self._layout[kernel.PERIOD_FROM])
        information, score = h.copy(), r - h @ memory.theta
        h[:], r[:] = 0.0, 0.0
        self._layout[kernel.PERIOD_FROM] = self._layout[kernel.COUNT]
        inverse, empty = information_inverse(information, None)
        zone = slice(memory.eta, memory.eta + 2)
        if not count or (np.abs(empty[zone]) > 1e-6 * np.abs(empty).max(axis=0, initial=1e-300)).any():
            return None
        left, right = (memory.theta[zone] + (inverse @ score)[zone]) * self._scales[0]
        covariance = memory.variance * inverse[zone, zone] * self._scales[0] ** 2
        wide = covariance[0, 0] + covariance[1, 1] - 2.0 * covariance[0, 1]
        spread = dict(zip(("left", "right", "width"), np.sqrt([*np.diag(covariance), wide]).tolist(), strict=True))
        reach = 0.25 * (memory.state[kernel.HIGH] - memory.state[kernel.LOW]) * self._scales[0]
        if not max(spread["left"], spread["right"]) < reach:
            return None
        return {"left": float(left), "right": float(right), "width": float(right - left)}, spread, count

    def to_bytes(self) -> bytes:
        """Whole state; :meth:`from_bytes` continues bit by bit where this one stands."""
        header = {
            "format": FORMAT, "settings": self._settings, "seen": self._seen, "next_try": self._next_try,
            "events": [asdict(event) for event in self._events],
        }  # fmt: skip
        buffer = io.BytesIO()
        np.savez(
            buffer,
            header=np.frombuffer(json.dumps(header).encode(), dtype=np.uint8),
            gathered=np.array(self._gathered),
            scales=np.array(self._scales),
            state=np.zeros(0) if self._state is None else self._state,
            layout=self._layout,
        )
        return buffer.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> Self:
        """Estimator from the bytes of :meth:`to_bytes`.

        Raises
        ------
        DataError
            The bytes are something else.
        """
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as stored:
                parts = {name: stored[name] for name in ("header", "gathered", "scales", "state", "layout")}
            header = json.loads(parts["header"].tobytes())
            if header["format"] != FORMAT:
                raise ValueError(header["format"])
            new = cls(**header["settings"])
            new._restore(header, parts)
        except (*_BROKEN, AttributeError) as error:
            raise DataError.expected("the bytes of to_bytes()", f"{len(data)} other bytes", "save it again") from error
        return new

    def _restore(self, header: dict[str, Any], parts: dict[str, Any]) -> None:
        """Take over what was stored; ValueError where the arrays do not fit the layout: the kernel does not look."""
        self._seen, self._next_try = int(header["seen"]), int(header["next_try"])
        self._events = [ChangeEvent(**event) for event in header["events"]]
        gathered = parts["gathered"]
        self._gathered = (gathered[0].tolist(), gathered[1].tolist())
        self._scales = (float(parts["scales"][0]), float(parts["scales"][1]))
        if not parts["state"].size:
            return
        layout, settings = np.ascontiguousarray(parts["layout"]), self._settings
        if layout.shape != (kernel.LAYOUT_SIZE,) or layout.dtype != np.int64:
            raise ValueError("layout")
        p = int(layout[kernel.P])
        if not 0 <= p * p < parts["state"].size:
            raise ValueError("layout")
        made = allocate(settings["na"], settings["nb"], settings["delay"], p, self._tuning)
        if parts["state"].shape != made[0].shape or parts["state"].dtype != made[0].dtype:
            raise ValueError("state")
        fixed = [*range(kernel.COUNT), kernel.RING_S, kernel.INVERSE]
        if not np.array_equal(layout[fixed], made[1][fixed]):
            raise ValueError("layout")
        limits = {kernel.FILLED: kernel.BLOCK, kernel.WINDOW: kernel.RING, kernel.BLOCKS: kernel.COUNT}
        if not all(0 <= layout[count] <= layout[most] - (count == kernel.FILLED) for count, most in limits.items()):
            raise ValueError("counters")
        self._state, self._layout = np.ascontiguousarray(parts["state"]), layout
        self._psi = np.zeros(int(layout[kernel.N]))
