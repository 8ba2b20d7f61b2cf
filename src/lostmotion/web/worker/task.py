"""A job of a page as it is handed to the worker, and the files that hold what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from lostmotion.errors import DataError, FileAccessError
from lostmotion.files.results import read_json, write_json
from lostmotion.files.schema import anything, checked, each, flag, group, or_null, table, text, whole, within

LOOK, RESULT, STUDY, BLOCK, FIT, EXPORT = (f"{n}.json" for n in ("look", "result", "study", "block", "fit", "export"))
BRIEF = "brief.json"  # of the result: what a list shows of it
RECORD, ZIP = "record", "block.zip"
DROPPED = "dropped-file"  # name of what was dropped, wherever it came from; messages show its label instead
READING = ("op", "pv", "sp", "position", "time", "mode", "dt", "loop", "op_span", "pv_span", "automatic", "manual",
           "quality", "uncertain")  # fmt: skip
MOST = 1 << 20  # columns, loops, words of a list
ERROR = group(text=text(), parts=each(text(), 3), ways=each(table(anything), 1000), type=text())
SHAPES = {  # of what lists show: one file that somebody changed is one bad file
    LOOK: within(columns=each(text(), MOST), rows=each(each(text(), MOST), MOST), roles=table(text(), MOST),
                 loops=each(text(), MOST), more=whole()),
    BRIEF: group(failed=flag(), verdict=or_null(text(100)), words=text()),
    RESULT: within({"error": or_null(ERROR), "diagnosis": within(verdict=text(100))}),
    STUDY: within({"error": or_null(ERROR)}),
    EXPORT: within({"error": or_null(ERROR)}),
}  # fmt: skip
JUDGING = ("loop_type", "integrating", "tolerance")


@dataclass(frozen=True)
class Task:
    """One job as it is handed to the worker.

    Attributes
    ----------
    kind : {"read", "study", "block"}
    folder : str
        Where results go.
    sources : tuple of str
        Paths of the data.
    label : str
        What people call the file.
    tag : str
        Name of the loop, where the data do not tell it.
    asked : mapping
        Settings of READING and JUDGING that were chosen.
    given : mapping
        What the kind of job wants besides.
    """

    kind: str
    folder: str
    sources: tuple[str, ...] = ()
    label: str = ""
    tag: str = ""
    asked: Mapping[str, Any] = field(default_factory=dict)
    given: Mapping[str, Any] = field(default_factory=dict)

    @property
    def place(self) -> Path:
        """Folder of the results."""
        return Path(self.folder)

    def chosen(self, names: tuple[str, ...]) -> dict[str, Any]:
        """Settings of these names that were chosen."""
        return {name: value for name, value in self.asked.items() if name in names and value is not None}


def failure(text: str) -> dict[str, Any]:
    """Error of a result that is none of the library."""
    return {"text": text, "parts": [], "ways": [], "type": "failure"}


def brief_of(result: Mapping[str, Any], words: str = "") -> dict[str, Any]:
    """What a list shows of a result: lists of hundreds of loops do not read all of each."""
    error = result.get("error")
    verdict = None if error or "diagnosis" not in result else result["diagnosis"]["verdict"]
    return {"failed": error is not None, "verdict": verdict, "words": str(error["text"]) if error else words}


def keep_result(folder: Path, result: Mapping[str, Any], words: str = "") -> None:
    """Write a result of reading and diagnosing; it is there as soon as its file is."""
    write_json(folder / BRIEF, brief_of(result, words), force=True)
    write_json(folder / RESULT, result, force=True)


def outcome_of(folder: Path, name: str) -> dict[str, Any] | None:
    """What a task wrote; None: nothing yet, or something that is not what it writes."""
    if not (folder / name).is_file():
        return None
    try:
        found = read_json(folder / name, "a result", "do it again")
        return checked(found, SHAPES.get(name, anything), "a result", "do it again")  # type: ignore[no-any-return]
    except (DataError, FileAccessError):
        return None
