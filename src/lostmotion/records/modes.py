"""Mode of the controller in each row: what the words of a mode column mean."""

from __future__ import annotations

from collections.abc import Mapping
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
    **dict.fromkeys(("iman", "init", "track", "tracking", "trk", "lo", "local", "local override"), "detached"),
    **dict.fromkeys(("o/s", "oos", "out of service", "off", "bypass", "shutdown", "halt"), "detached"),
}


def rows_of(kind: Kind, mode: StringArray | None, words: Mapping[str, str] | None = None) -> Bools | None:
    """Rows in a mode of this kind; None where no mode is recorded.

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
    """
    if mode is None:
        return None
    known = WORDS | _checked(words)
    meant = {word for word, meaning in known.items() if meaning == kind}
    return np.array([word.strip().lower() in meant for word in mode.tolist()], dtype=np.bool_)


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
    return sorted({word for word in mode.tolist() if word.strip() and word.strip().lower() not in known})


def _checked(words: Mapping[str, str] | None) -> dict[str, str]:
    given = {str(word).strip().lower(): meaning for word, meaning in (words or {}).items()}
    for word, meaning in given.items():
        if meaning not in KINDS:
            raise ParameterError.expected(
                f"a meaning among {list(KINDS)}", f"{word!r}: {meaning!r}", "see the docstring"
            )
    return given
