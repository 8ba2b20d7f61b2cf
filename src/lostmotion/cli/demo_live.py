"""``lostmotion demo-live``."""

from __future__ import annotations

import asyncio
import math
from typing import TYPE_CHECKING, Annotated

import typer

from lostmotion.cli.online import stop_on_signals
from lostmotion.errors import ParameterError

if TYPE_CHECKING:
    from threading import Event

    from lostmotion.live.opcua.demo_server import DemoServer

FASTEST = 20.0  # scans of 25 ms
Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port on this machine; 0: a free one.")]
Speed = Annotated[float, typer.Option("--speed", help="Times as fast as a plant, at most 20.")]
Seconds = Annotated[float | None, typer.Option("--seconds", help="End after so many; default: go on until Ctrl-C.")]


def demo_live(port: Port = 4840, speed: Speed = 1.0, seconds: Seconds = None) -> None:
    """Run a plant to try the live link on: a level and a flow loop with worn valves, behind OPC UA on this machine.

    Example: lostmotion demo-live --port 4840 --speed 2

    Each loop has a supervised block, whose inputs and outputs are nodes too: ask it for other widths, and accept with
    its node ACCEPT. Neither signed nor encrypted, and everybody on this machine may write: a bench. Ctrl-C ends it.
    """
    if not 0 < speed <= FASTEST:
        raise ParameterError.expected(f"--speed above 0, at most {FASTEST:g}", speed, "give another")
    if seconds is not None and not 0 <= seconds < math.inf:
        raise ParameterError.expected("--seconds of 0 or more", seconds, "leave it out to go on until Ctrl-C")
    from lostmotion.live.opcua.demo_server import DemoServer
    from lostmotion.live.virtual_plant import VirtualPlant

    with stop_on_signals() as stop:
        asyncio.run(_served(DemoServer(VirtualPlant.worn(), port, speed), stop, seconds))


async def _served(server: DemoServer, stop: Event, seconds: float | None) -> None:
    typer.echo("INSECURE: a bench on this machine, whose every user may write to it; no plant.", err=True)
    async with server:
        typer.echo(_introduction(server.address, server.period))
        await server.run(stop, math.inf if seconds is None else seconds)


def _introduction(address: str, dt: float) -> str:
    flow = "--op 'ns=2;s=FIC102.OP' --pv 'ns=2;s=FIC102.PV' --orders 1,0,1"
    return f"""Plant at {address}: level LIC101 and flow FIC102 with worn valves, blocks LY101 and FY102.

In another terminal:
  lostmotion live --discover {address} --insecure
  lostmotion live {address} {flow} --dt {dt:g} --report-every 100 --insecure

Ctrl-C ends it."""
