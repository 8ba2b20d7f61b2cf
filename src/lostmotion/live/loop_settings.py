"""What is watched of a loop, and how: the same for a plant file and for the command line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from lostmotion.errors import ParameterError
from lostmotion.files.layout import Layout
from lostmotion.files.results import read_json
from lostmotion.identify import FitFacts, RecursiveML, read_fit
from lostmotion.live.loop_source import Signals, patience_of
from lostmotion.online.monitor import OnlineMonitor
from lostmotion.online.watched_fit import watched_model

SAME = 0.01  # share by which the sampling times of a fit and of a loop may differ


@dataclass(frozen=True)
class LoopSettings:
    """A loop to be watched.

    Attributes
    ----------
    tag : str
    nodes : dict of str
        Node ids by role: "op", "pv", and "sp" or "mode" where they are read.
    dt : float, optional
        Sampling time in seconds; None: that of the fit.
    fit, diagnosis : Path, optional
        Results of ``identify --out`` and ``diagnose --out``.
    orders : (int, int, int), optional
        na, nb, delay, where there is no fit.
    gain, noise, forgetting, start_samples, accept
        As the options of ``lostmotion online``.
    watch : dict
        report_every, trend_every, op_limits, frozen of :class:`lostmotion.online.OnlineMonitor`.
    width_limit : float, optional
    automatic : tuple of str
        What the mode says in automatic; empty: the usual words.
    uncertain : "bad" or "keep"
        What a value of uncertain quality is.
    on_change : bool
        The server tells PV only where it has changed.
    """

    tag: str
    nodes: dict[str, str]
    dt: float | None = None
    fit: Path | None = None
    diagnosis: Path | None = None
    orders: tuple[int, int, int] | None = None
    gain: float | None = None
    noise: str | int = "auto"
    forgetting: float = 0.9998
    start_samples: int = 1000
    accept: str | None = None
    watch: dict[str, Any] = field(default_factory=dict)
    width_limit: float | None = None
    automatic: tuple[str, ...] = ()
    uncertain: str = "bad"
    on_change: bool = False

    def model(self) -> Model:
        """Settings of the estimator, behind the gate.

        Raises
        ------
        GateError
            The fit shows no dead zone, and no reason says why to go on.
        ParameterError
            Neither fit nor orders, no sampling time, or one that is not that of the fit.
        """
        fit = None if self.fit is None else read_fit(self.fit)
        said = None if self.diagnosis is None else read_json(self.diagnosis, "a diagnosis", "use diagnose --out")
        settings, accepted = watched_model(fit, self.orders, self.gain, self.noise, said, self.accept)
        settings |= {"forgetting": self.forgetting, "start_samples": self.start_samples}
        return Model(settings, self._dt(fit), accepted)

    def _dt(self, fit: FitFacts | None) -> float:
        known = None if fit is None else float(fit.dt)
        if self.dt is None and known is None:
            raise ParameterError.expected(f"dt of loop {self.tag!r}", "none", "give the sampling time in seconds")
        dt = self.dt if self.dt is not None else known
        assert dt is not None  # noqa: S101  one of the two is there
        if dt <= 0 or (known is not None and abs(known - dt) > SAME * dt):
            raise ParameterError.expected(f"a fit at dt = {dt:g} s > 0", f"{known or dt:g} s", "check dt and the fit")
        return dt


@dataclass(frozen=True)
class Model:
    """Settings of an estimator, its sampling time, and what was accepted to get them."""

    settings: dict[str, Any]
    dt: float
    accepted: str

    def signals(self, loop: LoopSettings, publishing: float) -> Signals:
        """What is read of the loop."""
        return Signals(loop.tag, loop.nodes, self.dt, patience_of(self.dt, publishing), loop.on_change)

    def maker(self, loop: LoopSettings) -> Callable[[Layout], OnlineMonitor]:
        """What makes the monitor of a new start."""

        def make(layout: Layout) -> OnlineMonitor:
            estimator = RecursiveML(**self.settings, dt=self.dt)
            return OnlineMonitor(estimator, dt=self.dt, calendar=layout.calendar, **loop.watch)

        return make


def publishing_of(times: list[float]) -> float:
    """Seconds between messages of the server: a quarter of the shortest sampling time, 0.1 to 0.5 s."""
    return min(0.5, max(0.1, 0.25 * min(times)))
