"""Names that every PLC tool takes: lower case, no reserved word, no double or trailing underscore."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from lostmotion.errors import ParameterError
from lostmotion.export.tree import Name

LONGEST = 32  # Schneider
RESERVED = frozenset(
    """
    abs abstract acos action add and any array asin at atan begin bool boolean break by byte case char class concat
    configuration constant continue cos ctd ctu date default delete dint div do double dt dword else elsif en
    end end_if end_var enablein enableout eno enum eq exit exp expt extends extern false f_edge final find float for
    from function ge goto gt if implements inline insert int interface internal le left len limit ln log long lreal lt
    max method mid min mod move mul mux namespace ne not null of on or override pi pointer private program property
    protected public r_edge real ref reference register repeat replace resource restrict retain return right rol ror
    sel shl shr short signed sin sint sizeof sqrt static step string struct sub super switch tan task then this time to
    tod transition true trunc type typedef udint uint ulint union unsigned until usint var void volatile while with
    word xor
    """.split()  # noqa: SIM905  a list of words reads better than a list of strings
)
PREFIX = {"parameter": "set", "input": "given", "output": "shown", "state": "kept", "local": "temp"}


def block_name(name: str) -> str:
    """The name of a block, checked.

    Raises
    ------
    ParameterError
        No identifier that every tool takes.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*", name) or len(name) > LONGEST:
        raise ParameterError.expected(
            f"a block name of letters, digits and single underscores, up to {LONGEST} long", name, "e.g. FY_101_comp"
        )
    if name.lower() in RESERVED:
        raise ParameterError.expected("a block name that is no reserved word", name, "e.g. FY_101_comp")
    return name


def plc_names(variables: Iterable[Name], taken: Iterable[str] = ()) -> Mapping[Name, str]:
    """Name in the PLC of each variable: lower case, prefixed where it would be reserved or taken.

    Raises
    ------
    ParameterError
        A name that cannot be made fit.
    """
    used = {name.lower() for name in taken}
    result: dict[Name, str] = {}
    for variable in variables:
        text = variable.name.lower().strip("_")
        if text in used or text in RESERVED:
            text = f"{PREFIX[variable.section]}_{text}"
        if text in used or not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", text) or len(text) > LONGEST:
            raise ParameterError.expected("a variable name that fits a PLC", variable.name, "rename it in the kernel")
        used.add(text)
        result[variable] = text
    return result
