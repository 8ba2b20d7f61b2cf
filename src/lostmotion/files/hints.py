"""Columns that may be OP and PV: for the command in a message, never for reading."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from lostmotion.files.names import ALIASES, CLOCKS, DATES, SAMPLING_NAMES
from lostmotion.files.tags import isa, key, tag_and_role

# Parts of names. The longest that fits decides; ties leave a column to either role.
LIKE_OP = ("out", "op", "cv", "co", "mv", "fv", "lv", "tv", "valve", "volt", "cmd", "command", "input", "u", "control")
LIKE_PV = ("pv", "meas", "flow", "level", "temp", "press", "speed", "rpm", "output", "y", "ft", "lt", "pt", "tt", "x")
NO_SIGNAL = ("id", "index", "row", "no", "nr", "sample", "direction", "error", "status", "quality")
MOST = 3  # commands in a message


def likely(names: Sequence[str], found: Mapping[str, str]) -> list[dict[str, object]]:
    """Settings op and pv that may be meant, likeliest first; none where nothing speaks for any.

    Examples
    --------
    >>> likely(["id", "FT_115", "LV_106", "Date Time"], {})
    [{'op': 'LV_106', 'pv': 'FT_115'}]
    >>> likely(["time", "voltage", "rpm"], {})
    [{'op': 'voltage', 'pv': 'rpm'}]
    >>> likely(["Zeit", "Istwert", "Ventil 7"], {})
    [{'op': 'Ventil 7', 'pv': 'Istwert'}]
    """
    free = [name for name in names if name not in found.values() and not _known(name)]
    ops = [found["op"]] if "op" in found else _like("op", free)
    pvs = [found["pv"]] if "pv" in found else _like("pv", free)
    pairs = [(op, pv) for op in ops for pv in pvs if op != pv]
    if not pairs and len(free) == 2 and not found:
        both = [(free[0], free[1]), (free[1], free[0])]
        pairs = [(op, pv) for op, pv in both if not (_called("pv", op) or _called("op", pv))]
    pairs.sort(key=lambda pair: -_common(*pair))
    return [{"op": op, "pv": pv} for op, pv in pairs[:MOST]]


def _known(name: str) -> bool:
    """Whether a column is known to be something else: a time, a set point, a mode."""
    word = key(name)
    taken = (*ALIASES["time"], *ALIASES["sp"], *ALIASES["mode"], *SAMPLING_NAMES, *DATES, *CLOCKS, *NO_SIGNAL)
    parsed = tag_and_role(name)
    return word in (*taken, "sp", "mode", "position") or (parsed is not None and parsed[1] in ("sp", "mode"))


def _called(role: str, name: str) -> bool:
    """Whether a column has the usual name of a role."""
    return key(name) in (role, *ALIASES[role])


def _like(role: str, names: Sequence[str]) -> list[str]:
    return [name for name in names if _leaning(name) == role]


def _leaning(name: str) -> str:
    """Role that the parts of a name speak for; empty: none."""
    parsed = tag_and_role(name)
    if parsed is not None:
        return parsed[1]
    word = key(name)
    tag = isa(name)
    if tag is not None:
        word = tag[1].lower()
    weights = {
        role: max((_weight(word, part) for part in parts), default=0)
        for role, parts in (("op", LIKE_OP), ("pv", LIKE_PV))
    }
    if weights["op"] == weights["pv"]:
        return ""
    return max(weights, key=lambda role: weights[role])


def _weight(word: str, part: str) -> int:
    """Letters of a part that a name holds: short ones only at an end of it."""
    inside = word.startswith(part) or word.endswith(part) if len(part) < 3 else part in word
    return len(part) if inside else 0


def _common(one: str, other: str) -> int:
    """Letters that two names share at either end."""
    ends = [0, 0]
    for place, (left, right) in enumerate(((one, other), (one[::-1], other[::-1]))):
        for a, b in zip(left, right, strict=False):
            if a != b:
                break
            ends[place] += 1
    return sum(ends)
