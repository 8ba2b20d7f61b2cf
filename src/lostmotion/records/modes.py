"""Mode of the controller in each row: what the words of a mode column mean."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Literal

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.records.record import StringArray
from lostmotion.records.sampling import Bools

Kind = Literal["automatic", "manual", "detached"]
KINDS = ("automatic", "manual", "detached")
# "detached": the valve need not follow OP (tracking, initialisation, local, out of service).
WORDS: dict[str, Kind] = {
    **dict.fromkeys(("a", "aut", "auto", "automatic", "c", "cas", "casc", "cascade", "auto/cas"), "automatic"),
    **dict.fromkeys(("rcas", "rsp", "remote", "remote sp", "acas", "ccas", "bcas", "pri", "prd"), "automatic"),
    **dict.fromkeys(("m", "man", "manual", "hand", "rout"), "manual"),
    **dict.fromkeys(
        ("iman", "init", "initman", "track", "tracking", "trk", "lo", "local", "local override"), "detached"
    ),
    **dict.fromkeys(("o/s", "oos", "out of service", "off", "bypass", "shutdown", "halt"), "detached"),
}


def rows_of(kind: Kind, mode: StringArray | None, words: Mapping[str, str] | None = None) -> Bools | None:
    """Rows in a mode of this kind; None where no mode is recorded, or none of its words means anything here.

    Parameters
    ----------
    kind : {"automatic", "manual", "detached"}
        Controller acts; operator acts; the valve need not follow OP.
    mode : ndarray of str, optional
        Words of the plant.
    words : mapping, optional
        Further words, e.g. ``{"1": "automatic", "0": "manual"}``: numbers have no common meaning.

    Examples
    --------
    >>> rows_of("manual", np.array(["AUTO", "Man", "1"]), {"1": "manual"})
    array([False,  True,  True])
    >>> rows_of("manual", np.array(["1", "1", "1"]))
    """
    if mode is None:
        return None
    known = WORDS | _checked(words)
    meant = [word for word, meaning in known.items() if meaning == kind]
    if not any(holds(cell, known) for cell in np.unique(mode).tolist()):
        return None
    cells, places = np.unique(mode, return_inverse=True)
    return np.array([holds(cell, meant) for cell in cells.tolist()], dtype=np.bool_)[places]


def words_of(kind: Kind) -> tuple[str, ...]:
    """Known words of one kind, in lower case.

    Examples
    --------
    >>> words_of("manual")
    ('m', 'man', 'manual', 'hand', 'rout')
    """
    return tuple(word for word, meaning in WORDS.items() if meaning == kind)


def holds(cell: str, words: Collection[str]) -> bool:
    """Whether a cell holds one of the words (in lower case); case and blanks do not matter, numbers are numbers.

    Examples
    --------
    >>> holds(" Auto", ["auto"]), holds("1.0", ["1"]), holds("", ["auto"])
    (True, True, False)
    """
    word = cell.strip().lower()
    if word in words:
        return True
    number = _number(word)
    return number is not None and any(_number(other) == number for other in words)


def unknown_words(mode: StringArray | None, words: Mapping[str, str] | None = None) -> list[str]:
    """Words of a mode column that mean nothing here.

    Examples
    --------
    >>> unknown_words(np.array(["AUTO", "3", "3", ""]))
    ['3']
    """
    if mode is None:
        return []
    known = WORDS | _checked(words)
    return [word for word in np.unique(mode).tolist() if word.strip() and not holds(word, known)]


def _number(word: str) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _checked(words: Mapping[str, str] | None) -> dict[str, str]:
    given = {str(word).strip().lower(): meaning for word, meaning in (words or {}).items()}
    for word, meaning in given.items():
        if meaning not in KINDS:
            raise ParameterError.expected(
                f"a meaning among {list(KINDS)}", f"{word!r}: {meaning!r}", "see the docstring"
            )
    return given
