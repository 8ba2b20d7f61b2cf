"""What a dialect of the exporter is, all in one place."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from lostmotion.errors import ParameterError
from lostmotion.export.source import Source


@dataclass(frozen=True)
class Dialect:
    """A language, or a file format around one, in which blocks are exported.

    Attributes
    ----------
    name : str
        What ``export(to=..)`` and ``--to`` take.
    title : str
        Language and tools, for the documentation.
    endings : tuple of str
        Endings of the files without the dot; no two dialects share one.
    files : callable
        Text of every file by file name, ``<name of the block>.<ending>``, from the
        :class:`~lostmotion.export.source.Source` of a block.
    restore : callable
        One text of IEC ST from those files, so that what was written can be executed. By rules on the text alone that
        know nothing of the tree it came from, word by word: a wrong operator stays wrong.
    how_to_import : str
        What a person does in the tool, for the commissioning page.
    proven, unproven : str
        What the tests of lostmotion do with the files, and what nobody has done, for the documentation.

    Raises
    ------
    ParameterError
        A part that is missing.
    """

    name: str
    title: str
    endings: tuple[str, ...]
    files: Callable[[Source], dict[str, str]]
    restore: Callable[[Mapping[str, str]], str]
    how_to_import: str
    proven: str
    unproven: str

    def __post_init__(self) -> None:
        for part in ("name", "title", "endings", "how_to_import", "proven", "unproven"):
            if not getattr(self, part):
                raise ParameterError.expected(f"a dialect with {part}", repr(getattr(self, part)), "say what it is")
        for part in ("files", "restore"):
            if not callable(getattr(self, part)):
                raise ParameterError.expected(f"a dialect with {part}", repr(getattr(self, part)), "give a function")
