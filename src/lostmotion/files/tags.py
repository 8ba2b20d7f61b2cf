"""Names of columns -> tag and role: FIC101.OUT is the OP of FIC101, FT_211 beside FV_211 are PV and OP of F211."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from functools import lru_cache

from lostmotion.files.names import CONTROLS, ENDS, ENDS_ANYWHERE, LOOP_TYPES, MEASURES, MOVES, SECONDS, UNITS

BRACKETS = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_CUT = re.compile(r"[\s_\-.]+")
_PART = re.compile(r"[^\s_\-./:\\]+")
_ISA = re.compile(r"^(?P<area>.*?[^A-Za-z])??(?P<letters>[A-Za-z]{2,4})[-_ .]?(?P<number>\d[\dA-Za-z]*)$")
_SUFFIX = re.compile(r"(?<=\d)([A-Za-z]?)_+\d\w*$")  # of a file that is one of many of a loop: FIC20102__1207_0004
NAMES = 1 << 16  # of columns that are remembered: each is asked for by every role
Loops = dict[str, dict[str, str]]


@lru_cache(maxsize=NAMES)
def folded(name: str) -> str:
    """Lower case without accents.

    Examples
    --------
    >>> folded("Führungsgröße"), folded("Posición")
    ('fuhrungsgrosse', 'posicion')
    """
    plain = unicodedata.normalize("NFKD", name.strip().lower().replace("ß", "ss"))
    return "".join(letter for letter in plain if not unicodedata.combining(letter))


@lru_cache(maxsize=NAMES)
def key(name: str) -> str:
    """Name without case, accents, separators and unit, for comparison.

    Examples
    --------
    >>> key("Set_Point [m3/h]"), key("t_s"), key("T (ms)"), key("Stellgröße %")
    ('set point', 't', 't', 'stellgrosse')
    """
    words = _CUT.split(folded(BRACKETS.sub("", name)))
    if len(words) > 1 and (words[-1] in SECONDS or words[-1] in UNITS):
        words = words[:-1]
    return " ".join(words)


@lru_cache(maxsize=NAMES)
def tag_and_role(name: str) -> tuple[str, str] | None:
    """Tag and role of a column that is called by both; None: by something else.

    Examples
    --------
    >>> tag_and_role("FIC-101/PID1/OUT.CV"), tag_and_role("FIC101 PV [m3/h]"), tag_and_role("T_out")
    (('FIC-101/PID1', 'op'), ('FIC101', 'pv'), None)
    >>> tag_and_role("FIC101_OUT"), tag_and_role("TI101_OUT")
    (('FIC101', 'op'), None)
    """
    bare = BRACKETS.sub("", name.strip())
    words = re.split(r"[\s_]+", bare)
    if len(words) > 1 and words[-1].lower() in UNITS:
        bare = bare[: -len(words[-1]) - 1].rstrip(" _")
    parts = [(found.group(), found.start()) for found in _PART.finditer(bare)]
    for count in (2, 1):
        if len(parts) <= count:
            continue
        start = parts[-count][1]
        word = " ".join(part.lower() for part, _ in parts[-count:])
        behind = bare[start - 1]
        for role, ends in ENDS.items():
            tag = bare[: start - 1].rstrip(" _-./:\\")
            if word in ends and (behind in "./:\\" or word in ENDS_ANYWHERE or _is_controller(tag)):
                return tag, role
    return None


def loops_of(names: Iterable[str]) -> Loops:
    """Loops whose OP and PV are both there, by tag, with the column of each role.

    Examples
    --------
    >>> loops_of(["Time", "FIC1.PV", "FIC1.OP", "FIC2.PV", "FIC2.OP", "TI3.PV"])
    {'FIC1': {'pv': 'FIC1.PV', 'op': 'FIC1.OP'}, 'FIC2': {'pv': 'FIC2.PV', 'op': 'FIC2.OP'}}
    >>> loops_of(["FT_211", "FV_211", "LT-3"])
    {'F211': {'pv': 'FT_211', 'op': 'FV_211'}}
    """
    names = list(names)
    found: Loops = {}
    twice: set[str] = set()  # two columns of one role: not to be told apart
    for name in names:
        tag, role = tag_and_role(name) or ("", "")
        if role in found.get(tag, {}):
            twice.add(tag)
        elif role:
            found.setdefault(tag, {})[role] = name
    whole = {tag: roles for tag, roles in found.items() if {"op", "pv"} <= set(roles) and tag not in twice}
    return whole or _isa_loops(names)


def _isa_loops(names: Sequence[str]) -> Loops:
    """Transmitters and valves of the same letter and number."""
    found: dict[str, dict[str, list[str]]] = {}
    for name in names:
        parsed, role = isa(name), isa_role(name)
        if parsed is not None and role:
            area, letters, number = parsed
            found.setdefault(f"{area}{letters[0]}{number}", {}).setdefault(role, []).append(name)
    return {
        tag: {role: columns[0] for role, columns in roles.items()}
        for tag, roles in found.items()
        if {"op", "pv"} <= set(roles) and all(len(columns) == 1 for columns in roles.values())
    }


@lru_cache(maxsize=NAMES)
def isa(name: str) -> tuple[str, str, str] | None:
    """Area, letters and number of an ISA-5.1 tag; None where it is none.

    Examples
    --------
    >>> isa("2111FIC40102E"), isa("FT_211 [m3/h]"), isa("RHT.7050-342_FIC60101"), isa("valve")
    (('2111', 'FIC', '40102E'), ('', 'FT', '211'), ('RHT.7050-342_', 'FIC', '60101'), None)
    """
    found = _ISA.match(BRACKETS.sub("", name.strip()))
    if found is None:
        return None
    letters = found["letters"].upper()
    return (found["area"] or "", letters, found["number"]) if letters[0] in LOOP_TYPES else None


def isa_role(name: str) -> str:
    """Role of a transmitter or a valve by its ISA-5.1 letters; empty: neither.

    Examples
    --------
    >>> isa_role("FT_211"), isa_role("LV-106"), isa_role("FIC101")
    ('pv', 'op', '')
    """
    parsed = isa(name)
    behind = "" if parsed is None else parsed[1][1:]
    return "pv" if behind in MEASURES else "op" if behind in MOVES else ""


def _is_controller(tag: str) -> bool:
    """Whether a tag is that of a controller (FIC101): its output is an OP, that of an indicator is none."""
    parsed = isa(tag)
    return parsed is not None and parsed[1][1:] in CONTROLS


def loop_type(tag: str) -> str:
    """What PV measures by the first letter of an ISA-5.1 tag; empty: it is none.

    Examples
    --------
    >>> loop_type("FIC-101"), loop_type("2411PDIC10321/PID1"), loop_type("Pump 3"), loop_type("F211")
    ('flow', 'pressure', '', '')
    >>> loop_type("2411FIC20102__1207_0004"), loop_type("LIC-7B_2"), loop_type("Pump 3_2")
    ('flow', 'level', '')
    """
    bare = without_run(tag)
    for part in (tag, bare, *re.split(r"[./:\\]", bare)):
        parsed = isa(part)
        if parsed is not None and parsed[1][1:] in (*CONTROLS, *MEASURES, *MOVES):
            return LOOP_TYPES[parsed[1][0]]
    return ""


def without_run(name: str) -> str:
    """Name of a file that is one of many of a loop, without what tells them apart.

    Examples
    --------
    >>> without_run("2411FIC20102__1207_0004"), without_run("LIC-7B_2"), without_run("stiction-F-2003")
    ('2411FIC20102', 'LIC-7B', 'stiction-F-2003')
    """
    return _SUFFIX.sub(r"\1", name)


def same_tag(one: str, other: str) -> bool:
    """Whether two names of a loop are the same but for case, separators and the letters IC.

    Examples
    --------
    >>> same_tag("FIC-102", "fic102"), same_tag("FIC-211", "F211"), same_tag("FIC-102", "FIC-1021")
    (True, True, False)
    """
    return bool(_names_of(one) & _names_of(other))


def one_loop(one: str, other: str) -> bool:
    """Whether two tags are of one loop: the same, blocks of one module, or of the same ISA-5.1 letter and number.

    Examples
    --------
    >>> one_loop("FIC101/PID1", "FIC101/AO1"), one_loop("FV-101", "FIC101"), one_loop("FIC101", "FIC102")
    (True, True, False)
    """
    first, second = (tag.split("/")[0] for tag in (one, other))
    parsed = [isa(tag) for tag in (first, second)]
    numbers = {(area, letters[0], number) for area, letters, number in filter(None, parsed)}
    return same_tag(first, second) or (None not in parsed and len(numbers) == 1)


@lru_cache(maxsize=NAMES)
def _names_of(tag: str) -> frozenset[str]:
    bare = re.sub(r"[\s_\-./:\\]+", "", tag).lower()
    parsed = isa(tag)
    if parsed is None or parsed[1][1:] not in CONTROLS:
        return frozenset({bare})
    return frozenset({bare, re.sub(r"[\s_\-./:\\]+", "", f"{parsed[0]}{parsed[1][0]}{parsed[2]}").lower()})
