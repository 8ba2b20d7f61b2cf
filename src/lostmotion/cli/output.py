"""What commands write and print: files that are there are refused before any work is done."""

from __future__ import annotations

import json as json_module
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from io import BytesIO
from pathlib import Path
from typing import Annotated, Any

import typer

from lostmotion.cli.closed_output import SHOWN, say
from lostmotion.cli.options import number
from lostmotion.cli.progress import progress
from lostmotion.errors import FileAccessError

FORMATS = (".png", ".pdf", ".svg")

Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
Force = Annotated[bool, typer.Option("--force", help="Replace files that are already there.")]
Figure = Annotated[Path | None, number("--figure", "Write the figure here (png, pdf or svg).")]
Figures = Annotated[
    Path | None, number("--figure", "Write the figure here (png, pdf or svg); of several files: a folder.")
]
Out = Annotated[Path | None, number("--out", "Write the result as JSON.")]


@dataclass(frozen=True)
class PrintOptions:
    """How a command prints."""

    json: Json = False

    def show(self, text: str, data: dict[str, Any] | list[dict[str, Any]]) -> None:
        """Print a result as text or as JSON; where nobody reads on, the exit code still says what was found."""
        progress("")
        say(json_module.dumps(data, indent=2, allow_nan=False) if self.json else text)
        SHOWN.set(True)


@dataclass(frozen=True)
class OutputOptions(PrintOptions):
    """How a command prints, and whether it may replace files."""

    force: Force = False

    def refuse(self, *paths: Path | None, figures: tuple[Path | None, ...] = (), table: Path | None = None) -> None:
        """Refuse what could not be written.

        Raises
        ------
        FileAccessError
            A file is there and `force` is not set, its folder is not or cannot be written, two outputs are one file,
            or a figure has no format that can be drawn.
        ParameterError
            A table has no format that can be written.
        MissingExtraError
            A figure is asked for, and the package that draws it is not installed.
        """
        given = [path for path in (*paths, *figures, table) if path is not None]
        if not given:
            return
        from lostmotion.files.write import known_format
        from lostmotion.files.writer import refuse

        if table is not None:
            known_format(table)
        for path in figures:
            if path is not None and path.suffix.lower() not in FORMATS:
                raise FileAccessError(f"expected a figure as png, pdf or svg, got {path}; give one of these endings")
        if any(path is not None for path in figures):
            from lostmotion.extras import need_extra

            need_extra("plot")
        for path in given:
            refuse(path, self.force)
        if len({os.path.realpath(path) for path in given}) < len(given):
            raise FileAccessError(f"expected a file for each output, got one for two of {len(given)}; name them apart")

    def write_json(self, path: Path | None, data: Any) -> None:
        """Write a result, where it is wanted."""
        if path is not None:
            self.write_text(path, json_module.dumps(data, indent=2, allow_nan=False) + "\n")

    def keeper(self, path: Path | None) -> Callable[[Any], None] | None:
        """Writer of a result that grows: each time whole, so that what is done is kept whenever the command ends."""
        if path is None:
            return None
        mine = self

        def write(data: Any) -> None:
            nonlocal mine
            mine.write_json(path, data)
            mine = replace(self, force=True)

        return write

    def write_text(self, path: Path, text: str) -> None:
        """Write a page."""
        from lostmotion.files.writer import write_bytes

        write_bytes(path, text.encode("utf-8"), self.force)

    def write_figure(self, path: Path | None, result: Any) -> None:
        """Draw a result, where that is wanted."""
        if path is not None:
            from lostmotion.files.writer import write_bytes

            stream = BytesIO()
            result.plot().savefig(stream, format=path.suffix.lower()[1:], dpi=120)
            write_bytes(path, stream.getbuffer(), self.force)


def places(files: list[Path], target: Path | None, what: str, ending: str) -> dict[Path, Path]:
    """Where what is written of each file goes: the target itself, or of several files a file in that folder.

    Raises
    ------
    FileAccessError
        The target of several files is a file, or two of them would write the same file.
    """
    if target is None:
        return {}
    if len(files) == 1:
        return {files[0]: target}
    from lostmotion.files.paths import is_file, is_folder  # the readers, which no command needs to be read

    if is_file(target) or (target.suffix.lower() in (ending, *FORMATS) and not is_folder(target)):
        remedy = "give the name of a folder, which is made"
        raise FileAccessError(f"expected a folder for the {what} of several files, got {target}; {remedy}")
    found = {file: target / f"{file.stem}{ending}" for file in files}
    if len(set(found.values())) < len(found):
        raise FileAccessError(f"expected files of different names for the {what}, got two alike; run them apart")
    return found
