"""What a command reads a record from: a file, several files of one tag each, a folder of them, one loop of many."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextvars import ContextVar
from functools import lru_cache
from os.path import commonprefix
from pathlib import Path
from typing import TYPE_CHECKING

from lostmotion.addresses import is_url, without_password
from lostmotion.cli.commands_on import commands_on
from lostmotion.cli.progress import progress
from lostmotion.cli.wording import RUNNING, message
from lostmotion.errors import InputError
from lostmotion.printable import shell_line

if TYPE_CHECKING:
    from lostmotion.cli.options import RecordOptions
    from lostmotion.files.opened import Opened
    from lostmotion.records import LoopRecord

    _Path = Path
else:
    _Path = type(Path())  # of the system; only from Python 3.12 on Path itself can be inherited from


MANY = 100_000  # samples: what a command does with them takes a while
TYPED: ContextVar[tuple[str, ...]] = ContextVar("TYPED", default=())  # options of the record that was read last


class Source(_Path):
    """A path that stands for more than a file, or for less: it prints and is named as the commands want it.

    Attributes
    ----------
    words : tuple of str
        What is typed for it.
    loop : str or None
        The one loop of it that is meant.
    """

    words: tuple[str, ...] = ()
    loop: str | None = None

    @classmethod
    def of(cls, words: Sequence[str], loop: str | None = None) -> Source:
        """Source of what was typed."""
        made = cls(words[0])
        made.words, made.loop = tuple(words), loop
        return made

    @property
    def stem(self) -> str:
        """Name of the loop, or of what was typed, without its ending."""
        if self.loop is not None:
            return "".join("_" if sign in "/\\:" else sign for sign in self.loop)
        if not self.words:
            return super().stem
        if is_url(self.words[0]):
            return Path(self.words[0].split("?", maxsplit=1)[0]).stem
        stems = [Path(word).absolute().stem for word in self.words]
        return commonprefix(stems).rstrip(" _-.") or stems[0]  # noqa: RUF071  names, not paths

    def __str__(self) -> str:
        named = ["--loop", self.loop] if self.loop is not None else []
        if not self.words:
            return super().__str__()
        typed = [*words_of(self), *named]
        return shell_line(typed) if len(typed) > 1 else typed[0]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Source) and (self.words, self.loop) == (other.words, other.loop)

    def __hash__(self) -> int:
        return hash((self.words, self.loop))


def words_of(file: Path) -> list[str]:
    """What is typed for a file, without the options."""
    words = [without_password(word) for word in file.words] if isinstance(file, Source) else [str(file)]
    return [f"./{word}" if word.startswith("-") else word for word in words]  # a name, and no option


def named_as(file: Path) -> dict[str, str]:
    """File, and the loop of it where one of several is meant, JSON-ready."""
    loop = file.loop if isinstance(file, Source) else None
    words = words_of(file)
    named = {"file": shell_line(words) if len(words) > 1 else words[0]}
    return named if loop is None else {**named, "loop": loop}


def is_address(file: Path) -> bool:
    """Whether a file is the address of a database."""
    return isinstance(file, Source) and is_url(file.words[0])


def as_path(typed: str | Path) -> Path:
    """What was typed as a path; the address of a database keeps its slashes."""
    return Source.of([str(typed)]) if is_url(str(typed)) else Path(typed)


def sources(files: list[Path], columns: RecordOptions, every_loop: bool = False) -> list[Path]:
    """One for each record: files of one tag each are one together, those of a folder or a pattern are told apart.

    Parameters
    ----------
    files : list of Path
        As they were typed.
    columns : RecordOptions
        Options of the record.
    every_loop : bool
        Each loop of a wide file is a record, where none was named.
    """
    _content.cache_clear()
    found = [one for typed in _by_record(files) for one in typed]
    if not every_loop or columns.loop is not None:
        return found
    return [one for file in found for one in _by_loop(file, columns, alone=len(found) == 1)]


def _by_record(files: list[Path]) -> list[list[Path]]:
    from lostmotion.files.gathered import gathered, grouped

    several = {file: inside for file in files if not is_address(file) and (inside := gathered(file)) is not None}
    if len(files) == 1 and not several:
        return [list(files)]
    flat = [path for file in files for path in several.get(file, (file,))]
    groups = grouped(list(dict.fromkeys(flat))) if len(set(flat)) == len(flat) else list(flat)
    if len(groups) == 1 and isinstance(groups[0], tuple):
        return [[Source.of([str(file) for file in files])]]
    return [[Source.of([str(path) for path in one]) if isinstance(one, tuple) else one] for one in groups]


def _by_loop(file: Path, columns: RecordOptions, alone: bool) -> list[Path]:
    loops = loops_in(file, columns, alone)
    words = file.words if isinstance(file, Source) else (str(file),)
    return [Source.of(words, loop) for loop in loops] if loops else [file]


def loops_in(file: Path, columns: RecordOptions, alone: bool = True) -> tuple[str, ...]:
    """Names of the loops of a file that holds several, where none was named.

    A file that cannot be opened has none here: reading it says why. Of several files only the first rows are read.
    """
    from lostmotion.errors import LostMotionError
    from lostmotion.files.opened import loops_of_file

    if columns.loop is not None:
        return ()
    try:
        if alone or isinstance(file, Source):
            return content_of(file, columns).loops(columns.op, columns.pv)
        return loops_of_file(file, columns.op, columns.pv)
    except LostMotionError:
        return ()


def content_of(file: Path, columns: RecordOptions) -> Opened:
    """What a file holds; it is opened once for all loops that are read from it one after another."""
    words = file.words if isinstance(file, Source) else (str(file),)
    asked = (columns.op, columns.pv, columns.sp, columns.mode)
    return _content(words, columns.query, columns.uncertain, columns.ignore_quality, *asked)


@lru_cache(maxsize=1)
def _content(words: tuple[str, ...], query: str | None, uncertain: str, ignored: bool, *asked: str | None) -> Opened:
    from lostmotion.files.opened import opened
    from lostmotion.files.quality import Trust
    from lostmotion.files.watch import watched

    source = list(words) if len(words) > 1 else words[0]
    trust = Trust(not ignored, uncertain == "keep")
    with watched(progress):
        content = opened(source, [name for name in asked if name], query, trust)
    progress("")
    return content


def read_as(file: Path, read: Callable[..., LoopRecord], columns: RecordOptions) -> LoopRecord:
    """Record of a file by `read`; an error of one loop leads on by commands that name it."""
    record = _read_as(file, read, columns)
    if len(record) >= MANY:
        progress(f"working on {len(record)} rows ..")
    return record


def _read_as(file: Path, read: Callable[..., LoopRecord], columns: RecordOptions) -> LoopRecord:
    from lostmotion.cli.next_steps import typed

    TYPED.set(tuple(typed(columns)))
    loop = file.loop if isinstance(file, Source) else None
    if loop is None:
        content = content_of(file, columns)
        _content.cache_clear()  # not kept while the record is worked on
        return read(content)
    try:
        return read(content_of(file, columns), loop=loop)
    except InputError as error:
        raise _of_loop(error, [*words_of(file), *TYPED.get()], loop) from error


def _of_loop(error: InputError, words: list[str], loop: str) -> InputError:
    """The same error with commands that name the loop."""
    lines = commands_on(error.leads_on(*({"loop": loop, **way} for way in error.ways)), [RUNNING.get(), *words])
    return type(error)(". Type ".join([message(error), " or ".join(lines)]) if lines else message(error))
