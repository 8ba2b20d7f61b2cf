"""``lostmotion online``."""

from __future__ import annotations

import json as json_module
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from threading import Event
from typing import TYPE_CHECKING, Annotated, Any

import typer

import lostmotion as lm
from lostmotion.cli.closed_output import echo
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.identify import Noise, read_noise, read_orders
from lostmotion.cli.options import ColumnOptions, number
from lostmotion.cli.output import Json
from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from lostmotion.files.layout import Layout
    from lostmotion.online import OnlineMonitor

Source = Annotated[str, typer.Argument(help="CSV or text file that grows, or - for standard input.")]
Orders = Annotated[str | None, number("--orders", "na,nb,delay as in 3,2,3; or give --fit.")]
Fit = Annotated[
    Path | None,
    number("--fit", "Result of `identify --out`: orders, noise order, gain."),
]
Gain = Annotated[float | None, number("--gain", "Known static gain of the process behind the valve.")]
Forgetting = Annotated[float, typer.Option("--forgetting", help="1 - 1/memory in samples; 1 forgets at changes only.")]
Start = Annotated[int, typer.Option("--start-samples", help="Samples of the first window, which is fitted in batch.")]
Mode = Annotated[
    str | None,
    number("--mode", "Column of the controller mode: learn in automatic only."),
]
Auto = Annotated[
    list[str] | None,
    typer.Option(
        "--auto-value", help="What the mode column holds in automatic; default AUTO, CAS ..", show_default=False
    ),
]
Limits = Annotated[
    tuple[float, float] | None,
    number("--op-limits", "Where OP saturates, e.g. 0 100: no learning there."),
]
Frozen = Annotated[
    int | None,
    number("--frozen", "Equal values of PV in a row that mean a frozen transmitter."),
]
Width = Annotated[
    float | None,
    number("--width-limit", "Width of the dead zone at which something must be done."),
]
ReportEvery = Annotated[int, typer.Option("--report-every", min=1, help="Samples from report to report.")]
TrendEvery = Annotated[
    int | None,
    number("--trend-every", "Samples to a point of the trend; default: ten reports."),
]
State = Annotated[
    Path | None,
    number("--state", "File that keeps all that is known, to go on after a stop."),
]
Follow = Annotated[bool, typer.Option("--follow/--no-follow", help="Wait for more rows, or stop at the end.")]


@dataclass(frozen=True)
class EstimatorOptions:
    """Orders and gain, given or from a fit, and how fast the past is forgotten."""

    orders: Orders = None
    fit: Fit = None
    gain: Gain = None
    noise: Noise = "auto"
    forgetting: Forgetting = 0.9998
    start_samples: Start = 1000

    def given(self, gate: GateOptions) -> tuple[dict[str, Any], str]:
        """Settings of the estimator; and what was accepted to get them."""
        model, accepted = _model(self.fit, self.orders, self.gain, self.noise, gate)
        return model | {"forgetting": self.forgetting, "start_samples": self.start_samples}, accepted


@dataclass(frozen=True)
class WatchOptions:
    """How often is reported, and where nothing is learned."""

    report_every: ReportEvery = 1000
    trend_every: TrendEvery = None
    op_limits: Limits = None
    frozen: Frozen = None


def online(
    source: Source,
    estimator: EstimatorOptions,
    columns: ColumnOptions,
    watched: WatchOptions,
    gate: GateOptions,
    mode: Mode = None,
    auto_value: Auto = None,
    width_limit: Width = None,
    state: State = None,
    follow: Follow = True,
    json: Json = False,  # noqa: ARG001  the output is JSON in any case
) -> None:
    """Watch the dead zone of a loop in service: one JSON line per report, event or note.

    Example: lostmotion online FIC-101.csv --fit fic101.json --state fic101.state --width-limit 3

    Ctrl-C and SIGTERM keep the state and exit with 0; after a kill the next start goes on from the state file, and
    lines since it was last written come again. Standard input: tail -F log.csv | lostmotion online - --orders 2,1,3

    The rows since the last report get one at the end of the input, unless --state keeps them for the next start.

    At the end of the input the exit code is 1 where a change was found, the width is above its limit, or the record
    did not tell, by all rows up to the end; and before any work where the fit shows no dead zone, unless
    --accept REASON says why to go on. No other kind is watched.
    """
    from lostmotion.files.follow import Follower
    from lostmotion.files.growing import GrowingFile
    from lostmotion.files.layout import Asked
    from lostmotion.online.service import Kept, Service

    (model, accepted), watch = estimator.given(gate), asdict(watched)
    automatic = tuple(auto_value or ())
    asked = Asked(columns.op, columns.pv, columns.time_column, mode, automatic, columns.dt)
    rows = sys.stdin.buffer if source == "-" else Path(source)
    if isinstance(rows, Path):
        GrowingFile(rows).close()  # one that cannot be read is refused before the folder of a state is made
    with (
        stop_on_signals() as stop,
        Kept(state, {**model, **watch}) as kept,
        Follower(rows, asked, kept.position) as follower,
    ):

        def make(layout: Layout) -> OnlineMonitor:
            return _monitor(layout, model, watch, estimator.fit)

        if accepted:
            _emit({"kind": "note", "line": 0, "message": f"ACCEPTED behind a closed gate: {accepted}."})
        service = Service(follower, kept, make, _emit, width_limit)
        service.run(follow, stop)
        raise typer.Exit(0 if stop.is_set() or service.quiet else 1)


def _model(
    fit: Path | None, orders: str | None, gain: float | None, noise: str, gate: GateOptions
) -> tuple[dict[str, Any], str]:
    """Settings of the estimator, from the options or else from a fit; and what was accepted to get them."""
    from lostmotion.online.watched_fit import watched_model

    known = None if fit is None else lm.read_fit(fit)
    if orders is None and fit is None:
        raise ParameterError.expected("--orders or --fit", "neither", "e.g. --orders 3,2,3")
    wanted = None if orders is None else read_orders(orders)
    return watched_model(known, wanted, gain, read_noise(noise), **gate.given())


def _monitor(layout: Layout, model: dict[str, Any], watch: dict[str, Any], fit: Path | None) -> OnlineMonitor:
    from lostmotion.online import OnlineMonitor

    if fit is not None:
        known = lm.read_fit(fit).dt
        if abs(known - layout.dt) > 0.01 * layout.dt:
            raise ParameterError.expected(f"a fit at dt = {layout.dt:g} s", f"{known:g} s", "check --dt and the fit")
    return OnlineMonitor(lm.RecursiveML(**model, dt=layout.dt), dt=layout.dt, calendar=layout.calendar, **watch)


@contextmanager
def stop_on_signals() -> Iterator[Event]:
    """Event that the first signal sets; a second one of its kind does what it did before."""
    stop = Event()
    before: dict[int, Any] = {}

    def handle(number: int, _: object) -> None:
        stop.set()
        signal.signal(number, before[number])

    if threading.current_thread() is threading.main_thread():
        numbers = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
        before = {number: signal.signal(number, handle) for number in numbers}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _emit(message: dict[str, Any]) -> None:
    echo(json_module.dumps(message, allow_nan=False))
    if sys.stderr.isatty():
        from lostmotion.report.online_text import online_line

        echo(online_line(message), err=True)
