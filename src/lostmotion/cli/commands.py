"""The commands: names and help in one table, each loaded when it is called."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup

from lostmotion.cli.exit_codes import TABLE
from lostmotion.cli.groups import spread
from lostmotion.cli.pairs import named
from lostmotion.cli.wording import OFFERED, RUNNING
from lostmotion.errors import one_line

COMMANDS = {  # the first line of each command's docstring; a test compares them
    "check": "Say what a record holds and what of it can be used: "
    "sampling, gaps, flat stretches, saturation, excitation.",
    "diagnose": "Say what is wrong with a loop: "
    "actuator, tuning, disturbance or sensor, how sure that is, and what to do.",
    "identify": "Find the lost motion of the actuator, of whichever kind, and the process behind it, with intervals.",
    "compensate": "Apply the plain inverse of a dead zone to the controller output and write it as OP_compensated.",
    "simulate": "Simulate the loop without, with and with mis-estimated compensation, before anything is downloaded.",
    "design": "Design the test that tells most about the dead zone, or say what a record can at best tell.",
    "export": "Write the compensating block as code for a PLC, with test vectors and a page for commissioning.",
    "online": "Watch the dead zone of a loop in service: one JSON line per report, event or note.",
    "live": "Watch the dead zones of a running plant over OPC UA: "
    "one JSON line per report, event or note, with its tag.",
    "request": "Ask the block of a loop for the widths of a fit: first as a study, with --write in the plant.",
    "solve": "Go the whole way from a record to a compensating block: check, diagnose, identify, simulate, block.",
    "audit": "Look at all loops of a plant: "
    "which valves need a hand, how sure that is, what swings with what, what is new.",
    "demo": "Go the whole way on a simulated loop: "
    "record, check, identify, compensate, figure, and the loop before and after.",
    "demo-plant": "Make a plant to try an audit on: a file a loop, a list of the loops, and the truth beside them.",
    "demo-live": "Run a plant to try the live link on: "
    "level, flow and temperature with worn valves, over OPC UA on this machine.",
    "serve": "Show a plant, its loops and dropped records as a page in the browser, on this machine only.",
    "warm-up": "Compile everything for this processor now, once, so that no later command waits for it.",
    "paper": "Make the tables and figures of the ICINCO 2010 paper again, beside the published values.",
}
USAGE_ERROR: Any = typer.BadParameter.__base__  # with its other kinds; Typer has no name for it
PLAIN: dict[str, Any] = {"add_completion": False, "pretty_exceptions_enable": False, "rich_markup_mode": None}


def command(name: str) -> Any:
    """Command of the table, imported and ready to run; errors then speak of its options.

    Raises
    ------
    KeyError
        No such command.
    """
    if name not in COMMANDS:
        raise KeyError(name)
    alone = typer.Typer(**PLAIN)
    alone.command(name)(spread(_function(name)))
    made = typer.main.get_command(alone)
    named(made.params)
    RUNNING.set(name)
    OFFERED.set(frozenset(option for parameter in made.params for option in parameter.opts))
    return made


def _function(name: str) -> Any:
    word = name.replace("-", "_")
    return getattr(import_module(f"lostmotion.cli.{word}"), word)


class Loaded(Mapping[str, Any]):
    """The commands of the table; a command is imported when it is looked up."""

    def __getitem__(self, name: str) -> Any:
        """Command `name`, ready to run."""
        return command(name)

    def __iter__(self) -> Iterator[str]:
        return iter(COMMANDS)

    def __len__(self) -> int:
        return len(COMMANDS)


@contextmanager
def _shown_errors() -> Iterator[None]:
    """Errors of wrong usage name words as they were typed, or as a pattern of the shell has found them."""
    try:
        yield
    except USAGE_ERROR as error:
        error.message = one_line(error.message)
        raise


class Commands(TyperGroup):
    """Group that shows its commands without loading them, and wrong usage so that a terminal only shows it."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        self.commands = Loaded()  # type: ignore[assignment]  # nobody adds to it

    def make_context(self, *given: Any, **settings: Any) -> Any:
        """As the parent does."""
        with _shown_errors():
            return super().make_context(*given, **settings)

    def invoke(self, ctx: Any) -> Any:
        """As the parent does."""
        with _shown_errors():
            return super().invoke(ctx)

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ARG002  the signature of the parent
        """Names in the order of work."""
        return list(COMMANDS)

    def format_commands(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """Names and their help, from the table."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def format_epilog(self, ctx: Any, formatter: Any) -> None:  # noqa: ARG002
        """Exit codes of all commands."""
        with formatter.section("Exit codes"):
            formatter.write_dl([(str(code), meaning) for code, meaning in TABLE.items()])
