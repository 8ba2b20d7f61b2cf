"""``lostmotion live``."""

from __future__ import annotations

import asyncio
import json as json_module
import sys
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from lostmotion.cli.closed_output import echo
from lostmotion.cli.gate import GateOptions
from lostmotion.cli.live_write import Write, one_at_a_time, supervised
from lostmotion.cli.online import Auto, EstimatorOptions, WatchOptions, Width, stop_on_signals
from lostmotion.cli.options import number
from lostmotion.cli.output import Json
from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from lostmotion.live.loop_settings import LoopSettings
    from lostmotion.live.opcua.link import Connect
    from lostmotion.live.plant_file import PlantFile
    from lostmotion.live.watch import Kinds

Source = Annotated[str, typer.Argument(help="Plant file (TOML), or address of a server: opc.tcp://host:port.")]
OpNode = Annotated[str | None, number("--op", "Node of the controller output: 'ns=2;s=FIC101.OP'.")]
PvNode = Annotated[str | None, number("--pv", "Node of the measurement.")]
SpNode = Annotated[str | None, number("--sp", "Node of the set point; only for --record.")]
ModeNode = Annotated[str | None, number("--mode", "Node of the controller mode: learn in automatic only.")]
Tag = Annotated[str, typer.Option("--tag", help="Name of the loop.")]
Dt = Annotated[float | None, number("--dt", "Sampling time in seconds; default: that of the fit.")]
OnChange = Annotated[
    bool, typer.Option("--on-change", help="The server tells PV only where it has changed: its last value holds.")
]
Uncertain = Annotated[
    Literal["keep", "bad"],
    typer.Option("--uncertain", help="Values of uncertain quality: missing as bad ones are, or kept."),
]
State = Annotated[Path | None, number("--state", "Folder with a state for each loop, to go on after a stop.")]
Record = Annotated[Path | None, number("--record", "Folder that keeps what came, as Parquet in pieces.")]
Store = Annotated[
    str | None,
    typer.Option("--store", metavar="FILE|URL", help="Store of an audit that takes the estimates, for its pages."),
]
Discover = Annotated[bool, typer.Option("--discover", help="Print the loops of the server as a loop list, and end.")]
Trust = Annotated[bool, typer.Option("--trust", help="Show the certificate of the server, ask, and believe it.")]
Fingerprint = Annotated[str | None, number("--fingerprint", "With --trust: believe it if its SHA-256 is this.")]
Pki = Annotated[Path | None, number("--pki", "Folder of certificates; default: in the user's configuration.")]
UserFile = Annotated[Path | None, number("--user-file", "File of mode 0600 with user and password, or certificate.")]
Insecure = Annotated[bool, typer.Option("--insecure", help="Neither signed nor encrypted: a bench on this machine.")]


@dataclass(frozen=True)
class NodeOptions:
    """Where one loop stands in the server."""

    op: OpNode = None
    pv: PvNode = None
    sp: SpNode = None
    mode: ModeNode = None
    tag: Tag = "loop"
    dt: Dt = None
    on_change: OnChange = False
    uncertain: Uncertain = "bad"


@dataclass(frozen=True)
class KeptOptions:
    """What is kept of it, and where."""

    state: State = None
    record: Record = None
    store: Store = None


@dataclass(frozen=True)
class LinkOptions:
    """Whom we believe, and who we are."""

    pki: Pki = None
    user_file: UserFile = None
    insecure: Insecure = False
    trust: Trust = False
    fingerprint: Fingerprint = None
    discover: Discover = False

    def connect(self, address: str, said: dict[str, Any], folder: Path) -> Connect:
        """What gives a client; the command line goes before what the plant file says in [security]."""
        from lostmotion.live.opcua.certificates import default_pki
        from lostmotion.live.opcua.client import check_address, connected
        from lostmotion.live.opcua.secrets import user_from
        from lostmotion.live.opcua.security import INSECURE, Identity
        from lostmotion.live.opcua.trust import TrustStore

        unknown = set(said) - {"pki", "user_file"}
        if unknown:
            raise ParameterError.expected("pki and user_file in [security]", sorted(unknown)[0], "leave it out")
        check_address(address)
        pki = self.pki or (folder / said["pki"] if "pki" in said else default_pki())
        user = self.user_file or (folder / said["user_file"] if "user_file" in said else None)
        if self.insecure and user is not None:
            raise ParameterError.expected("--insecure without a user file", user, "leave one of them out")
        identity = Identity(pki, None if self.insecure else user_from(user))
        if self.insecure:
            echo(INSECURE, err=True)
        return lambda: connected(address, identity, TrustStore(pki), self.insecure)


def live(
    source: Source,
    nodes: NodeOptions,
    link: LinkOptions,
    estimator: EstimatorOptions,
    watched: WatchOptions,
    gate: GateOptions,
    kept: KeptOptions,
    auto_value: Auto = None,
    width_limit: Width = None,
    write: Write = False,
    json: Json = False,  # noqa: ARG001  the output is JSON in any case
) -> None:
    """Watch the dead zones of a running plant over OPC UA: one JSON line per report, event or note, with its tag.

    Example: lostmotion live plant.toml --state states --record values

    One loop: lostmotion live opc.tcp://plc1:4840 --op 'ns=2;s=FIC101.OP' --pv 'ns=2;s=FIC101.PV' --fit fic101.json

    The first time: lostmotion live --trust opc.tcp://plc1:4840, and lostmotion live --discover opc.tcp://plc1:4840

    Only reads; with --write, and write = true for a block in the file, a supervisor asks that block for other widths,
    which the operator accepts or not. Ctrl-C and SIGTERM keep the states and exit with 0; the heartbeat of a supervisor
    ends with it, and its block sheds. The exit code is 1 where no loop can go on, the server is not believed, a fit
    shows no dead zone, or a supervisor had to end.
    """
    path = Path(source)
    plant: PlantFile | None = None
    if "://" in source:
        address, said, folder = source, {}, Path()
        loops: Callable[[], tuple[LoopSettings, ...]] = lambda: (  # noqa: E731
            _one(nodes, estimator, watched, gate, auto_value, width_limit),
        )
    else:
        from lostmotion.live.plant_file import read_plant_file

        plant = read_plant_file(path)
        address, said, folder, known = plant.address, plant.security, path.parent, plant.loops
        loops = lambda: known  # noqa: E731
    if link.trust:
        _trust(address, link)
        return
    connect = link.connect(address, said, folder)
    if link.discover:
        echo(asyncio.run(_discovered(connect)), end=False)
        return
    from lostmotion.live.watch import Kinds

    kinds = Kinds(kept.state, kept.record, kept.store, address)
    raise typer.Exit(0 if _watch(loops(), connect, kinds, plant, write) else 1)


def _watch(
    loops: tuple[LoopSettings, ...], connect: Connect, kept: Kinds, plant: PlantFile | None, write: bool
) -> bool:
    from lostmotion.live.warm import warm
    from lostmotion.live.watch import Watch

    emit = one_at_a_time(_emit)
    blocks = supervised(plant, connect, emit, write)
    with stop_on_signals() as stop:
        watch = Watch(loops, connect, emit, kept)
        watch.meet()  # compiling may take minutes
        warm()
        with nullcontext() if blocks is None else blocks.at_work(watch.watched):
            going = asyncio.run(watch.run(stop))
        return going and (blocks is None or not blocks.failed)


def _one(
    nodes: NodeOptions,
    estimator: EstimatorOptions,
    watched: WatchOptions,
    gate: GateOptions,
    auto_value: list[str] | None,
    width_limit: float | None,
) -> LoopSettings:
    """The loop of the command line."""
    from lostmotion.cli.identify import read_noise, read_orders
    from lostmotion.live.loop_settings import LoopSettings

    if nodes.op is None or nodes.pv is None:
        raise ParameterError.expected("--op and --pv", "an address alone", "name the nodes; --discover lists them")
    noise = estimator.noise
    return LoopSettings(
        tag=nodes.tag,
        nodes={role: name for role in ("op", "pv", "sp", "mode") if (name := getattr(nodes, role)) is not None},
        dt=nodes.dt,
        fit=estimator.fit,
        diagnosis=gate.diagnosis,
        orders=None if estimator.orders is None else read_orders(estimator.orders),
        gain=estimator.gain,
        noise=read_noise(noise),
        forgetting=estimator.forgetting,
        start_samples=estimator.start_samples,
        accept=gate.accept,
        watch=asdict(watched),
        width_limit=width_limit,
        automatic=tuple(auto_value or ()),
        uncertain=nodes.uncertain,
        on_change=nodes.on_change,
    )


async def _discovered(connect: Connect) -> str:
    from lostmotion.live.opcua.discover import discovered
    from lostmotion.plant import loop_list_text

    client = await connect()
    try:
        return loop_list_text(await discovered(client))
    finally:
        await client.disconnect()


def _trust(address: str, link: LinkOptions) -> None:
    """Believe a server from now on, with a fingerprint that somebody has compared."""
    from lostmotion.live.opcua.certificates import default_pki
    from lostmotion.live.opcua.introduction import introduced
    from lostmotion.live.opcua.trust import TrustStore

    shown = asyncio.run(introduced(address))
    echo(str(shown))
    if link.fingerprint is not None:
        shown.refuse_other(link.fingerprint)
    elif not sys.stdin.isatty() or not typer.confirm("Is this the fingerprint that the server itself shows?"):
        raise ParameterError.expected("--fingerprint, or a yes", "neither", "compare it at the server first")
    echo(f"believed: {shown.believed(TrustStore(link.pki or default_pki()))}")


def _emit(message: dict[str, Any]) -> None:
    echo(json_module.dumps(message, allow_nan=False))
    if sys.stderr.isatty():
        from lostmotion.report.online_text import online_line

        echo(f"{message['tag']}  {online_line(message)}", err=True)
