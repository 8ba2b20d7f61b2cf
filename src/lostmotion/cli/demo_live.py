"""``lostmotion demo-live``."""

from __future__ import annotations

import asyncio
import math
import shlex
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from lostmotion.cli.closed_output import echo
from lostmotion.cli.online import stop_on_signals
from lostmotion.cli.options import number
from lostmotion.errors import ParameterError
from lostmotion.printable import shell_word

if TYPE_CHECKING:
    from threading import Event

    from lostmotion.live.opcua.demo_server import DemoServer
    from lostmotion.live.virtual_plant import VirtualPlant

FASTEST = 20.0  # scans of 25 ms
Port = Annotated[int, typer.Option("--port", min=0, max=65535, help="Port on this machine; 0: a free one.")]
Speed = Annotated[float, typer.Option("--speed", help="Times as fast as a plant, at most 20.")]
Seconds = Annotated[float | None, typer.Option("--seconds", help="End after so many; default: go on until Ctrl-C.")]
Files = Annotated[Path | None, number("--files", "New folder for a plant file and a block, to try live --write with.")]
Plc = Annotated[str | None, number("--plc", "Command that runs the exported ST of a block: see docs/live.md.")]


def demo_live(
    port: Port = 4840, speed: Speed = 1.0, seconds: Seconds = None, files: Files = None, plc: Plc = None
) -> None:
    """Run a plant to try the live link on: level, flow and temperature with worn valves, over OPC UA on this machine.

    Example: lostmotion demo-live --port 4840 --speed 2 --files bench

    Each loop has a supervised block, whose inputs and outputs are nodes too: ask it for other widths, and accept with
    its node ACCEPT. Neither signed nor encrypted, and everybody on this machine may write: a bench. Ctrl-C ends it.
    """
    if not 0 < speed <= FASTEST:
        raise ParameterError.expected(f"--speed above 0, at most {FASTEST:g}", speed, "give another")
    if seconds is not None and not 0 <= seconds < math.inf:
        raise ParameterError.expected("--seconds of 0 or more", seconds, "leave it out to go on until Ctrl-C")
    from lostmotion.live.opcua.demo_server import DemoServer

    with stop_on_signals() as stop, closing(_plant(plc)) as plant:
        asyncio.run(_served(DemoServer(plant, port, speed), stop, seconds, files))


def _plant(plc: str | None) -> VirtualPlant:
    from lostmotion.live.virtual_plant import VirtualPlant

    if plc is None:
        return VirtualPlant.worn()
    from lostmotion.live.child_plc import ChildPlc

    words = shlex.split(plc)
    if not words:
        raise ParameterError.expected("a command behind --plc", "none", "leave it out for the compiled kernel")
    return VirtualPlant.worn(make_plc=partial(ChildPlc, command=words))


async def _served(server: DemoServer, stop: Event, seconds: float | None, files: Path | None) -> None:
    echo("INSECURE: a bench on this machine, whose every user may write to it; no plant.", err=True)
    async with server:
        made = None
        if files is not None:
            from lostmotion.live.demo_files import demo_files

            made = demo_files(files, server.address, server.plant.loops["TIC-103"], server.period)
        echo(_introduction(server.address, server.period, made))
        await server.run(stop, math.inf if seconds is None else seconds)


def _introduction(address: str, dt: float, made: Path | None) -> str:
    heat = "--op 'ns=2;s=TY103.OP_OUT' --pv 'ns=2;s=TIC103.PV' --orders 1,0,1"
    write = f"\n  lostmotion live {shell_word(str(made))} --write --insecure" if made is not None else ""
    return f"""Plant at {address}: level LIC101 and flow FIC102 with backlash, temperature TIC103 with a dead zone of 4,
blocks LY101, FY102 and TY103.

In another terminal:
  lostmotion live --discover {address} --insecure
  lostmotion live {address} {heat} --dt {dt:g} --report-every 100 --insecure{write}

Ctrl-C ends it."""
