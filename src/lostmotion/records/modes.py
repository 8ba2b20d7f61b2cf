"""Mode of the controller in each row: what the words of a mode column mean."""

from __future__ import annotations

import unicodedata
from collections.abc import Collection, Mapping
from functools import lru_cache
from typing import Literal

import numpy as np

from lostmotion.errors import ParameterError
from lostmotion.records.record import StringArray
from lostmotion.records.sampling import Bools

Kind = Literal["automatic", "manual", "detached"]
KINDS = ("automatic", "manual", "detached")
# "detached": the valve need not follow OP (tracking, initialisation, local, out of service).
# Lower case without accents, in the languages in which headers are known (lostmotion.files.names).
WORDS: dict[str, Kind] = {
    **dict.fromkeys(("a", "aut", "auto", "automatic", "c", "cas", "casc", "cascade", "auto/cas"), "automatic"),
    **dict.fromkeys(("rcas", "rsp", "remote", "remote sp", "acas", "ccas", "bcas", "pri", "prd"), "automatic"),
    **dict.fromkeys(("automatik", "automatikbetrieb", "automatisch", "kaskade", "extern"), "automatic"),
    **dict.fromkeys(("automatique", "automatico", "automatica", "cascada", "cascata"), "automatic"),
    **dict.fromkeys(("m", "man", "manual", "rout", "h", "hand", "handbetrieb", "manuell", "manuel"), "manual"),
    **dict.fromkeys(("manuelle", "mano"), "manual"),
    **dict.fromkeys(
        ("iman", "init", "initman", "track", "tracking", "trk", "lo", "local", "local override"), "detached"
    ),
    **dict.fromkeys(("o/s", "oos", "out of service", "off", "bypass", "shutdown", "halt"), "detached"),
    **dict.fromkeys(("nachfuhren", "nachfuehren", "lokal", "vor ort", "ausser betrieb", "aus"), "detached"),
    **dict.fromkeys(("poursuite", "hors service", "arret", "seguimiento", "fuera de servicio"), "detached"),
    **dict.fromkeys(("rastreamento", "fora de servico", "desligado", "apagado"), "detached"),
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
    ('m', 'man', 'manual', 'rout', 'h', 'hand', 'handbetrieb', 'manuell', 'manuel', 'manuelle', 'mano')
    """
    return tuple(word for word, meaning in WORDS.items() if meaning == kind)


def holds(cell: str, words: Collection[str]) -> bool:
    """Whether a cell holds one of the words (in lower case).

    Case, accents and blanks around it do not matter, and numbers are numbers.

    Examples
    --------
    >>> holds(" Auto", ["auto"]), holds("1.0", ["1"]), holds("", ["auto"]), holds("AUTOMÁTICO", ["automatico"])
    (True, True, False, True)
    """
    word = _plain(cell)
    if word in words or word in {_plain(one) for one in words}:
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


@lru_cache(maxsize=1 << 12)
def _plain(word: str) -> str:
    """Lower case, without accents and blanks around it."""
    letters = unicodedata.normalize("NFKD", word.strip().lower().replace("ß", "ss"))
    return "".join(letter for letter in letters if not unicodedata.combining(letter))


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
                f"a meaning among {list(KINDS)}", f"{word!r}: {meaning!r}", "choose one of them"
            )
    return given
