"""Errors in the words of the command line: ``dt=12`` of the library is ``--dt 12`` there."""

from __future__ import annotations

import ast
import re
from collections.abc import Collection
from contextvars import ContextVar

from lostmotion.printable import shell_word

# Settings of the library that errors name -> options; a command that lacks the option cannot follow the advice.
OPTIONS = {
    "accept": "--accept",
    "automatic": "--auto-value",
    "dt": "--dt",
    "diagnosis": "--diagnosis",
    "duration": "--duration",
    "gain": "--gain",
    "loop": "--loop",
    "method": "--method",
    "mode": "--mode",
    "noise": "--noise",
    "nonlinearity": "--nonlinearity",
    "op": "--op",
    "op_limits": "--op-limits",
    "op_span": "--op-span",
    "orders": "--orders",
    "position": "--position",
    "pv": "--pv",
    "pv_limits": "--pv-limits",
    "pv_span": "--pv-span",
    "quality": "--ignore-quality",
    "query": "--query",
    "uncertain": "--uncertain",
    "raw": "--raw",
    "sp": "--sp",
    "scan_time": "--scan-time",
    "span": "--span",
    "time": "--time",
    "wanted": "--interval",
}
FLAGS = {
    ("time", "False"): "--ignore-time",
    ("quality", "False"): "--ignore-quality",
    ("raw", "True"): "--raw",
    ("force", "True"): "--force",
    ("insecure", "True"): "--insecure",
    ("retune", "True"): "--retune",
}
OVERRIDE = OPTIONS["accept"]
WORDS = {"automatic": "WORD"}  # what stands for a value that the library leaves open, as in automatic=(..)
VALUE = r"<[^>]*>|'[^']*'|\"[^\"]*\"|\([^)]*\)|\[[^\]]*\]|\{[^}]*\}|[\w.+-]*\w"
BARE = re.compile(r"\b(give\s+)op_span(?=[\s.])")
SETTING = re.compile(rf"(?<![\w-])([a-z]\w*)=({VALUE})?(?!=)")
OFFERED: ContextVar[Collection[str]] = ContextVar("OFFERED", default=frozenset())  # options of the command that runs
RUNNING: ContextVar[str] = ContextVar("RUNNING", default="check")  # its name


def message(error: Exception, options: Collection[str] | None = None) -> str:
    """Text of an error for someone who typed a command.

    Parameters
    ----------
    error : Exception
        Any error; those of "expected X, got Y; do Z" are reworded, what was got stays as it is.
    options : collection of str, optional
        Options of the command, such as "--dt"; None: of the one that runs.

    Examples
    --------
    >>> from lostmotion.errors import InputError
    >>> error = InputError.expected("one clock", "two", "repair it, or pass dt=<seconds> and time=False")
    >>> message(error, ["--dt", "--ignore-time"])
    'expected one clock, got two; repair it, or pass --dt SECONDS --ignore-time'
    """
    said = getattr(error, "said", None)
    if said is None:
        before, end, remedy = str(error).rpartition("; ")
        return before + end + as_options(remedy)
    expected, got, remedy = said
    return (
        f"expected {as_options(expected)}, got {got}; {advice(remedy, OFFERED.get() if options is None else options)}"
    )


def advice(remedy: str, options: Collection[str]) -> str:
    """Remedy in options; of several ways out, those that this command offers.

    Examples
    --------
    >>> advice("rename the others, or say which: sp='SP 1'", ["--op"])
    'rename the others'
    >>> advice("rename the others, or say which: sp='SP 1'", ["--op", "--sp"])
    "rename the others, or say which: --sp 'SP 1'"

    To go on without a remedy is none: where nothing else is offered, the options are those of another command.

    >>> advice("identify with nonlinearity='auto', or give accept='<reason>'", ["--accept"])
    'identify with --nonlinearity auto, or give --accept REASON'
    """
    ways = remedy.split(", or ")
    offered = [way for way in ways if all(option in options for option in named_options(way))]
    remedies = [way for way in offered if named_options(way) != [OVERRIDE]]
    return ", or ".join(as_options(way) for way in (offered if remedies else ways))


def named_options(text: str) -> list[str]:
    """Options that stand for the settings in a text; a setting without option stands for itself.

    Examples
    --------
    >>> named_options("pass dt=<seconds> and time=False"), named_options("cases=3")
    (['--dt', '--ignore-time'], ['cases'])
    """
    return [option_of(*found.groups()) for found in SETTING.finditer(text)]


def as_options(text: str) -> str:
    """Text with options in place of settings.

    Examples
    --------
    >>> as_options("give op_limits=(low, high)"), as_options("name it with op='<column>'"), as_options("e.g. noise=4")
    ('give --op-limits LOW HIGH', 'name it with --op COLUMN', 'e.g. --noise 4')
    >>> as_options("give op_span where it is not")
    'give --op-span LOW HIGH where it is not'
    """
    text = text.replace("record.split()", "--split")
    options = SETTING.sub(lambda found: _as_option(found.group(0), *found.groups()), text)
    options = BARE.sub(r"\1--op-span LOW HIGH", options)
    return re.sub(r"(--dt \S+) and (?=--ignore-time)", r"\1 ", options)


def option_of(name: str, value: str | None) -> str:
    """Option of the command that runs for a setting of the library."""
    if name == "span" and OPTIONS[name] not in OFFERED.get() and OPTIONS["op_span"] in OFFERED.get():
        return OPTIONS["op_span"]  # where a record may be given the clamps are its span
    return FLAGS.get((name, value or ""), OPTIONS.get(name, name))


def _as_option(whole: str, name: str, value: str | None) -> str:
    option = option_of(name, value)
    if option == name:
        return whole
    return option if value is None or (name, value) in FLAGS else f"{option} {_words(name, value)}"


def _words(name: str, value: str) -> str:
    """Value as it is typed; capitals where the reader has to put one."""
    bare = value.strip("'\"")
    if bare.startswith("<"):
        return bare.strip("<>").upper()
    try:
        known = ast.literal_eval(value)
    except (SyntaxError, ValueError):
        parts = re.findall(r"\w+", value)
        return " ".join(part.upper() for part in parts) if parts else WORDS.get(name, "VALUE")
    listed = list(known.values()) if isinstance(known, dict) else known if isinstance(known, list | tuple) else [known]
    return " ".join(shell_word(str(part)) for part in listed)
