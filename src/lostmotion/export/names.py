"""Names that every PLC tool takes: lower case, no reserved word, no double or trailing underscore."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from lostmotion.errors import ParameterError
from lostmotion.export.reserved import why_reserved
from lostmotion.export.tree import Name

LONGEST = 32  # Schneider
SUFFIX = "_comp"
PREFIX = {"parameter": "set", "input": "given", "output": "shown", "state": "kept", "local": "temp"}


def block_name(name: str, variables: Iterable[str] = ()) -> str:
    """The name of a block, checked; `variables` are the names inside it.

    Raises
    ------
    ParameterError
        No identifier that every tool takes, or one that is something else in one of them.
    """
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*", name) or len(name) > LONGEST:
        raise ParameterError.expected(
            f"a block name of letters, digits and single underscores, up to {LONGEST} long", name, "e.g. FY_101_comp"
        )
    reason = why_reserved(name) or ("variable of the block" if name.lower() in variables else None)
    if reason is not None:
        other = f"{name[: LONGEST - len(SUFFIX)].rstrip('_')}{SUFFIX}"
        raise ParameterError.expected("a block name that no tool has taken", f"{name} ({reason})", f"e.g. {other}")
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
        if text in used or why_reserved(text):
            text = f"{PREFIX[variable.section]}_{text}"
        if text in used or not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", text) or len(text) > LONGEST:
            raise ParameterError.expected("a variable name that fits a PLC", variable.name, "rename it in the kernel")
        used.add(text)
        result[variable] = text
    return result
