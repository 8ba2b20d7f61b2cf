"""One command over several records: a line each as they are done, and an error is a line too."""

from __future__ import annotations

import ast
import json
import re
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import typer

from lostmotion.cli.closed_output import SHOWN, echo, say
from lostmotion.cli.commands_on import commands_on
from lostmotion.cli.options import RecordOptions
from lostmotion.cli.output import PrintOptions
from lostmotion.cli.progress import WHERE, progress
from lostmotion.cli.sources import TYPED, named_as, words_of
from lostmotion.cli.wording import RUNNING, as_options, message
from lostmotion.errors import FileAccessError, LostMotionError, one_line
from lostmotion.printable import label, shell_word


class Reported(Protocol):
    """A result that prints itself."""

    def summary(self) -> str:
        """Text for people."""
        ...

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        ...


Result = TypeVar("Result", bound=Reported)
_INDENTED, WIDTH = "\n      ", 96
STOPPED, LEFT = "Stopped", "stopped before it was done"
_MODES = re.compile(r"(Modes\s+(\S.*?)\s+are\s+not\s+known[^:]*:\s+)automatic=\(\.\.\)", re.DOTALL)


@dataclass(frozen=True)
class Outcome(Generic[Result]):
    """A file and what became of it: a result, or the class of an error and its text in the words of the command.

    `unwritten`: why its files could not be written; the result is there all the same.
    """

    file: Path
    result: Result | None
    failure: str = ""
    said: str | None = None
    unwritten: FileAccessError | None = None

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        if self.result is None:
            return {**named_as(self.file), "error": self.failure, "message": self.said}
        return {**named_as(self.file), **self.result.to_dict()}


def refuse_tag(files: list[Path], columns: RecordOptions) -> None:
    """Refuse one name for several loops, as wrong usage."""
    if len(files) > 1 and columns.tag is not None:
        raise typer.BadParameter("it names one loop; leave it out with several files", param_hint="--tag")


def each(
    files: list[Path],
    work: Callable[[Path], Result],
    line: Callable[[str, Result | None, str | None], str],
    quiet: bool,
    keep: Callable[[Any], None] | None = None,
    write: Callable[[Path, Result], None] | None = None,
) -> list[Outcome[Result]]:
    """Do the work for every file; tell and keep each of several as soon as it is done.

    Parameters
    ----------
    files : list of Path
    work : callable
        File -> result. The error of a single file is raised, that of one of several kept. After an interrupt by hand
        the files that are left have none.
    line : callable
        Name, result and error -> a line for each of several.
    quiet : bool
        Print the elements of a JSON list instead; :func:`tell` ends it.
    keep : callable, optional
        Given all that there is, JSON-ready and with names of files, after each.
    write : callable, optional
        Writes the files of one result. Where one cannot be written, here or by `keep`, the work goes on, and
        :func:`tell` raises the error when the results are told.
    """
    if len(files) == 1:
        only = Outcome(files[0], work(files[0]))
        return _kept([_wrote(only, write)], only.to_dict(), keep)
    outcomes: list[Outcome[Result]] = []
    now = outcomes
    kept: list[dict[str, Any]] = []
    for number, file in enumerate(files):
        stopped = bool(outcomes) and outcomes[-1].failure == STOPPED
        outcome = Outcome[Result](file, None, STOPPED, LEFT) if stopped else _watched(file, work, number, len(files))
        kept.append(outcome.to_dict())
        if quiet:
            say(("," if number else "[") + indent(f"\n{json.dumps(kept[-1], indent=2, allow_nan=False)}"), end=False)
        elif not stopped:
            say(line(label(file.stem), outcome.result, outcome.said))
        outcomes.append(_wrote(outcome, write))
        now = _kept(outcomes, kept, keep)
    return now


def _wrote(outcome: Outcome[Result], write: Callable[[Path, Result], None] | None) -> Outcome[Result]:
    if write is None or outcome.result is None:
        return outcome
    try:
        write(outcome.file, outcome.result)
    except FileAccessError as error:
        return replace(outcome, unwritten=error)
    return outcome


def _kept(outcomes: list[Outcome[Result]], data: Any, keep: Callable[[Any], None] | None) -> list[Outcome[Result]]:
    """All outcomes; the last with the error where all that there is could not be kept."""
    if keep is None:
        return outcomes
    try:
        keep(data)
    except FileAccessError as error:
        return [*outcomes[:-1], replace(outcomes[-1], unwritten=error)]
    return outcomes


def indent(text: str) -> str:
    """Lines of an element, as they stand in a list."""
    return text.replace("\n", "\n  ")


def _watched(file: Path, work: Callable[[Path], Result], number: int, total: int) -> Outcome[Result]:
    """Do one of several; an interrupt by hand is an outcome too."""
    before = WHERE.set(f"{number + 1} of {total}, {file.name}: ")
    try:
        progress("..")
        return _tried(file, work)
    except KeyboardInterrupt:
        echo(f"stopped at {one_line(str(file))}: {number} of {total} files are done", err=True)
        return Outcome(file, None, STOPPED, LEFT)
    finally:
        progress("")
        WHERE.reset(before)


def _tried(file: Path, work: Callable[[Path], Result]) -> Outcome[Result]:
    from numpy.linalg import LinAlgError

    try:
        return Outcome(file, work(file))
    except (LostMotionError, LinAlgError) as error:
        lines = commands_on(error, [RUNNING.get(), *words_of(file), *TYPED.get()])
        said = f"{message(error)}. Type {' or '.join(lines)}" if lines else message(error)
        return Outcome(file, None, type(error).__name__, said)


def modes_as_options(text: str) -> str:
    """Text in which the setting for a mode that is not known is the option; with its word, where there is one only.

    Examples
    --------
    >>> modes_as_options("Modes '1' are not known here; ... Say which means automatic: automatic=(..).")
    "Modes '1' are not known here; ... Say which means automatic: --auto-value 1."
    """
    return _MODES.sub(lambda found: found[1] + _auto_value(found[2]), text)


def _auto_value(shown: str) -> str:
    try:
        return f"--auto-value {shell_word(ast.literal_eval(shown))}"
    except (SyntaxError, ValueError, TypeError, AttributeError):  # several words
        return as_options("automatic=(..)")


def data_of(found: list[Outcome[Result]], named: bool = False) -> Any:
    """JSON-ready: a list of several outcomes, or the one result; `named`: with the file that it is of."""
    if len(found) > 1:
        return [one.to_dict() for one in found]
    only = found[0]
    return only.to_dict() if named or only.result is None else only.result.to_dict()


def _next(steps: Sequence[str]) -> str:
    """Last lines of a result: commands as they are pasted, words as a paragraph."""
    if all(step.startswith("lostmotion ") for step in steps):
        return f"Next: {_INDENTED.join(steps)}"
    return textwrap.fill(f"Next: {' '.join(steps)}", WIDTH, subsequent_indent="  ")


def tell(
    found: list[Outcome[Result]],
    table: Callable[[Sequence[tuple[str, Result | None]]], str],
    output: PrintOptions,
    accepted: Callable[[Result], bool],
    named: bool = False,
    next_steps: Callable[[Path, Result], Sequence[str]] | None = None,
) -> typer.Exit:
    """Print the one result with what to do next, or the table of several.

    Returns
    -------
    Exit
        To be raised: 0 where every result is there and accepted, else 1.

    Raises
    ------
    FileAccessError
        What is told could not be written.
    """
    steps = None
    if len(found) == 1 and found[0].result is not None:
        text = as_options(modes_as_options(found[0].result.summary()))
        steps = None if next_steps is None else list(next_steps(found[0].file, found[0].result))
        text = f"{text}\n{_next(steps)}" if steps else text
    else:
        text = "\n" + table([(label(one.file.stem), one.result) for one in found])
    if len(found) > 1 and output.json:
        say("\n]")
        SHOWN.set(True)
    else:
        data = data_of(found, named)
        output.show(text, data if steps is None else data | {"next": steps})
    for one in found:
        if one.unwritten is not None:
            raise one.unwritten
    return typer.Exit(0 if all(one.result is not None and accepted(one.result) for one in found) else 1)
