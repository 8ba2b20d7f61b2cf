"""Exit codes of all commands."""

from __future__ import annotations

from lostmotion.errors import GateError, ParameterError

DONE, ATTENTION, USAGE = 0, 1, 2
TABLE = {
    DONE: "done, and nothing needs attention",
    ATTENTION: "something needs attention: a finding, a record that cannot be used or does not tell, a closed gate or "
    "a failure; with several files, in any of them",
    USAGE: "wrong usage, and nothing was done: an unknown option, a value out of range, an input that does not exist",
}


def exit_code(error: Exception) -> int:
    """Code of an error that ends a command.

    Examples
    --------
    >>> from lostmotion.errors import DataError
    >>> exit_code(DataError("too short")), exit_code(ParameterError("dt < 0")), exit_code(GateError("not shown"))
    (1, 2, 1)
    """
    absent = isinstance(error.__cause__, FileNotFoundError)
    wrong = isinstance(error, ParameterError) and not isinstance(error, GateError)
    return USAGE if absent or wrong else ATTENTION
