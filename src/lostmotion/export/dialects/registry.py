"""All dialects by name."""

from __future__ import annotations

from collections.abc import Mapping

from lostmotion.errors import ParameterError
from lostmotion.export.dialects import c99, l5x, plcopen, scl, structured_text, tcpou
from lostmotion.export.dialects.dialect import Dialect

TARGETS: dict[str, Dialect] = {}


def register(dialect: Dialect) -> None:
    """Add a dialect: export, replay, commissioning page and command line know it then.

    Raises
    ------
    ParameterError
        A name or an ending of files that another one has.
    """
    endings = {ending for known in TARGETS.values() for ending in known.endings}
    if dialect.name in TARGETS or endings & set(dialect.endings):
        got = f"{dialect.name} ({', '.join(dialect.endings)})"
        raise ParameterError.expected("a dialect with a name and endings of its own", got, "choose others")
    TARGETS[dialect.name] = dialect


def restore(files: Mapping[str, str]) -> str:
    """IEC ST of an exported block, whatever its dialect.

    Raises
    ------
    ParameterError
        No files of a dialect that is known.
    """
    endings = {name.rpartition(".")[2] for name in files}
    for dialect in TARGETS.values():
        if endings == set(dialect.endings):
            return dialect.restore(files)
    raise ParameterError.expected("the files of an exported block", list(files), "pass what export() returned")


for _module in (structured_text, plcopen, tcpou, scl, l5x, c99):
    register(_module.DIALECT)
