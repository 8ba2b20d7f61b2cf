"""Texts that want to become code, and what is left of an exported file without the text that others wrote."""

import copy
import re
import shutil
import subprocess
from functools import cache
from xml.etree import ElementTree as ET

from hypothesis import strategies as st

from lostmotion.compensate import CompensatorBlock
from lostmotion.export import TARGETS
from lostmotion.export.source import Source
from tests.support.exports import COMMON, KINDS

MARK = "pwned_not_here_20260131"  # no text holds it
MARKS = (
    "*/", "/*", "*)", "(*", "*\\", "\\*", "\\", "//", "]]>", "<![CDATA[", "-->", "<!--", "<b>", "&#42;",
    "&lt;", "'", '"', "$'", "{", "}", "??/", "?\\?/", "\n", "\r", "\0", "\x0b", "\x85", "\u2028", "\u2029",
    "\uff0a\uff0f", "\uff0a\uff09", "\uff3c", "\uff1e", "\u2217/", "*\u0338/", "/\u0338*", "\u202e",
    "END_VAR", "END_FUNCTION_BLOCK", "int pwned;", "VAR pwned : BOOL; END_VAR", "pwned := TRUE;", "_step(",
    "{\n", "#include <pwned>", "double", "LREAL", "VERSION : 9", "BEGIN", "typedef struct {", "REAL#",
    "{ S7_x", "| a |", "`", "[a](b)", "%", "x", " ", "\ud7ff", "\U0001f40d",
)  # fmt: skip
texts = st.lists(st.sampled_from(MARKS) | st.text(max_size=3), max_size=12).map(lambda parts: "x" + "".join(parts))


@cache
def _translated(kind, real):
    return Source(CompensatorBlock.of(kind, 0.1, {**COMMON, **KINDS[kind]}), "FY_101", "2026-01-31", real)


def source_with(text, kind="backlash", real="real"):
    """A block with the text wherever others can write: record, fit, interval, reason, notes; translated once."""
    block = CompensatorBlock.of(kind, 0.1, {**COMMON, **KINDS[kind]}, (text, text), text)
    made = copy.copy(_translated(kind, real))
    for name, value in {"block": block, "data": text, "fit": text, "interval": text}.items():
        object.__setattr__(made, name, value)
    return made


def exported(target, text):
    return TARGETS[target].files(source_with(text))


def bare(files):
    """Everything but what the text may change, by parsers of XML and a C preprocessor that are not ours."""
    return bare_of([files])[0]


def bare_of(exports):
    """The same of many exports; the C of all of them by one start of the preprocessor."""
    found = [{name: BARE.get(_ending(name), _as_it_is)(text) for name, text in files.items()} for files in exports]
    places = [(k, name) for k, files in enumerate(exports) for name in files if _ending(name) in ("c", "h")]
    codes = _preprocessed([_with_header(exports[k], name) for k, name in places])
    for (k, name), code in zip(places, codes, strict=True):
        found[k][name] = code
    return found


def _ending(name):
    return name.rpartition(".")[2]


def _as_it_is(text):
    return text


def _with_header(files, name):
    text = files[name]
    both = files[name.rpartition(".")[0] + ".h"] + text if name.endswith(".c") else text
    return re.sub(r'^#include (".*"|<.*>)$', r"include_\1", both, flags=re.M)


def _preprocessed(codes):
    """C without comments, as gcc sees it; trigraphs and spliced lines included.

    Between two codes stands a mark: one that swallows it, or the code behind it, is another tree. What the codes define
    is undefined again behind each.
    """
    if not codes:
        return []
    names = sorted({name for code in codes for name in re.findall(r"#define (\w+)", code)})
    undefined = "".join(f"\n#undef {name}" for name in names)
    command = [str(shutil.which("gcc")), "-std=c99", "-E", "-P", "-x", "c", "-"]
    whole = f"{undefined}\n{MARK}\n".join(codes)
    done = subprocess.run(command, input=whole.encode(), capture_output=True, check=True)
    assert not done.stderr, done.stderr
    found = done.stdout.decode().split(MARK)
    assert len(found) == len(codes), f"{len(found)} codes out of {len(codes)}"
    return [code.strip() for code in found]


def _without_comments(text):
    """IEC comments do not nest in the standard, and nest in some tools: there must be no difference."""
    inside = re.findall(r"\(\*(.*?)\*\)", text, flags=re.S)
    assert not any(mark in said for said in inside for mark in ("(*", "*)", '"', "{", "}", "$", "\n"))
    left = re.sub(r"\(\*.*?\*\)", "(**)", text, flags=re.S)
    assert text.isascii()
    return left


def _tree(text):
    return list(_elements(ET.fromstring(text.encode()), said=True))  # noqa: S314  our own file


def _elements(element, said):
    """Names, attributes and text of all elements; below documentation, only that there is text and nothing else."""
    name = element.tag.rpartition("}")[2]
    said = said and name not in ("Comment", "documentation", "Description")
    attributes = {key: value for key, value in element.attrib.items() if key != "Id"}  # Id: a digest of all
    inside = (element.text or "") if said else ""
    code = _without_comments(inside) if name in ("Declaration", "ST", "Line", "p") else inside
    yield name, attributes, code.strip(), len(element), (element.tail or "").strip()
    for inner in element:
        yield from _elements(inner, said)


BARE = {
    "st": _without_comments, "scl": _without_comments, "xml": _tree,
    "TcPOU": _tree, "L5X": _tree,
}  # fmt: skip
