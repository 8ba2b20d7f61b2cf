"""A file on the desk of a page, or one loop of it: where it lies, how it is to be read, what was found."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from lostmotion.audit.plant_view import LoopView
from lostmotion.errors import DataError, FileAccessError, one_line
from lostmotion.files.results import read_json
from lostmotion.files.schema import checked, each, either, flag, group, kept, number, or_null, table, text
from lostmotion.web.desk.view_json import view_of_json
from lostmotion.web.worker.task import BRIEF, EXPORT, LOOK, RECORD, RESULT, STUDY, ZIP, brief_of, failure, outcome_of

ABOUT = "about.json"
LABEL = 120  # characters
LETTERS = frozenset("0123456789abcdef")
WHAT, REMEDY = "a dropped file as it was kept", "drop it again"
VALUE = either(text(), number(), flag(), or_null(each(either(text(), number()), 1000)))
PATH = kept("a path", lambda value: isinstance(value, str) and "\0" not in value)  # its bytes may be no text
SHAPE = group(
    label=text(), sources=each(PATH, 1 << 20), dropped=flag(), came=text(40), asked=table(VALUE), parent=text(16)
)


@dataclass(frozen=True)
class Item:
    """A file, or one loop of a file with several.

    Attributes
    ----------
    id : str
        16 hexadecimal digits: part of addresses.
    folder : Path
        Its own; nothing in it is named by who dropped the file.
    label : str
        What people call it; never a path.
    sources : tuple of str
        Paths of the data.
    dropped : bool
        The data lie in the folder, and go with it.
    came : str
        ISO moment, UTC.
    asked : mapping
        Settings that the reader of the page has chosen.
    parent : str
        Id of the file of which this is a loop; empty: it is one itself.
    """

    id: str
    folder: Path
    label: str
    sources: tuple[str, ...]
    dropped: bool = True
    came: str = ""
    asked: Mapping[str, Any] = field(default_factory=dict)
    parent: str = ""

    @property
    def loop(self) -> str:
        """Loop of the file that is meant; empty: there is one."""
        return str(self.asked.get("loop") or "")

    @property
    def name(self) -> str:
        """Of the loop where one is meant, else of the file."""
        return self.loop or self.label

    @property
    def stem(self) -> str:
        """The same without endings."""
        return self.loop or self.label.split(".", maxsplit=1)[0] or self.label

    @property
    def record_path(self) -> Path | None:
        """Folder of the record that was read (:mod:`lostmotion.web.kept_record`); None: not yet."""
        folder = self.folder / RECORD
        return folder if folder.is_dir() else None

    @property
    def look(self) -> dict[str, Any] | None:
        """Columns, rows, roles, loops (:func:`lostmotion.web.worker.looked.looked`)."""
        return outcome_of(self.folder, LOOK)

    @property
    def result(self) -> dict[str, Any] | None:
        """Check, diagnosis and fit, or the error; None: nothing yet."""
        return outcome_of(self.folder, RESULT)

    @property
    def brief(self) -> dict[str, Any] | None:
        """What a list shows of the result: "failed", "verdict", "words"; None: nothing yet."""
        if not (self.folder / RESULT).is_file():
            return None
        return outcome_of(self.folder, BRIEF) or brief_of(
            self.result or {"error": failure("Its result cannot be read.")}
        )

    @property
    def study(self) -> dict[str, Any] | None:
        """The way to a block, as far as it went, or the error; None: not asked for."""
        return outcome_of(self.folder, STUDY)

    @property
    def export(self) -> dict[str, Any] | None:
        """The block as it was written, or the error; None: not asked for."""
        return outcome_of(self.folder, EXPORT)

    @property
    def zip_path(self) -> Path:
        """Block as files for a tool."""
        return self.folder / ZIP

    @property
    def view(self) -> LoopView | None:
        """Rows for the page of the loop; None: there is no diagnosis."""
        found = self.result
        if found is None or "view" not in found:
            return None
        try:
            return view_of_json(found["view"])
        except DataError:
            return None

    def about(self) -> dict[str, Any]:
        """What is kept of it."""
        known = asdict(self)
        return {name: known[name] for name in ("label", "sources", "dropped", "came", "asked", "parent")}


def clean_label(text: str) -> str:
    r"""Name for people out of what a client sent: its last part, one line, not long.

    Examples
    --------
    >>> clean_label("../../etc/pass\nwd"), clean_label("C:/x/FIC-1.csv"), clean_label("..")
    ('pass\\nwd', 'FIC-1.csv', 'file')
    """
    last = one_line(text.replace("\\", "/").rsplit("/", maxsplit=1)[-1]).strip()
    return last[:LABEL] if last.strip(". ") else "file"


def present(folder: Path) -> Iterator[Item]:
    """Items that were kept, in the order in which they came."""
    places = [place for place in folder.iterdir() if len(place.name) == 16 and set(place.name) <= LETTERS]
    found = [item for place in places if (item := _item(place)) is not None]
    known = {item.id for item in found}
    yield from sorted((one for one in found if not one.parent or one.parent in known), key=lambda item: item.came)


def _item(place: Path) -> Item | None:
    try:
        known = checked(read_json(place / ABOUT, WHAT, REMEDY), SHAPE, WHAT, REMEDY)
    except (DataError, FileAccessError):
        return None
    return Item(place.name, place, **{**known, "sources": tuple(known["sources"])})
