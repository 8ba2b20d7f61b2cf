"""What check says of a file with several loops: which they are, and what to type next."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lostmotion.cli.next_steps import typed
from lostmotion.cli.options import RecordOptions
from lostmotion.cli.sources import content_of, loops_in, words_of
from lostmotion.printable import shell_line


@dataclass(frozen=True)
class ListedLoops:
    """Loops of a file, with the column of each role.

    Attributes
    ----------
    file : Path
        As it was typed.
    columns : dict of dict
        Column by role, by the name of the loop.
    types : dict of str
        What PV measures, by the name of the loop; empty where its tag does not tell.
    commands : tuple of str
        To go on with the first loop, and with all.
    """

    file: Path
    columns: dict[str, dict[str, str]]
    types: dict[str, str]
    commands: tuple[str, str]

    def summary(self) -> str:
        """In plain words."""
        width = max(len(name) for name in self.columns)
        rows = [
            f"    {name:{width}}  {self.types[name]:11}  {_roles(columns)}".rstrip()
            for name, columns in self.columns.items()
        ]
        name = Path(words_of(self.file)[0]).name
        return "\n".join(
            [
                f"{name} holds {len(rows)} loops:",
                *rows,
                "Next, one of them by its name:",
                f"    {self.commands[0]}",
                "or all of them, one after another:",
                f"    {self.commands[1]}",
            ]
        )

    def to_dict(self) -> dict[str, Any]:
        """JSON-ready."""
        loops = [
            {"loop": name, "loop_type": self.types[name], "columns": columns} for name, columns in self.columns.items()
        ]
        return {"file": str(self.file), "loops": loops, "commands": list(self.commands)}


def listed_loops(file: Path, columns: RecordOptions) -> ListedLoops | None:
    """Loops of a file that holds several, where none was named; else None."""
    from lostmotion.files.tags import loop_type

    loops = loops_in(file, columns)
    if not loops:
        return None
    content = content_of(file, columns)
    columns_of = content.columns()
    found = {name: columns_of.get(name, {}) for name in loops}
    words = [*words_of(file), *typed(columns)]
    commands = (
        f"lostmotion {shell_line(['check', *words, '--loop', loops[0]])}",
        f"lostmotion {shell_line(['diagnose', *words])}",
    )
    return ListedLoops(file, found, {name: loop_type(name) for name in loops}, commands)


def _roles(columns: dict[str, str]) -> str:
    return ", ".join(f"{role.upper() if len(role) == 2 else role} {name}" for role, name in columns.items())
