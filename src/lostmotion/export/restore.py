"""Every dialect turned back into one text of IEC ST, word by word, so that what was written can be executed.

The rules work on the text alone and know nothing of the tree it came from: a wrong operator stays wrong.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.etree import ElementTree as ET

from lostmotion.errors import ParameterError

XHTML = "{http://www.w3.org/1999/xhtml}"
TC6 = "{http://www.plcopen.org/xml/tc6_0201}"
C_TYPES = {"double": "LREAL", "float": "REAL", "bool": "BOOL", "int32_t": "DINT"}
Declaration = tuple[str, str, str, str]  # word of the section, name, type, default or ""


def restore(files: dict[str, str]) -> str:
    """IEC ST of an exported block.

    Raises
    ------
    ParameterError
        No dialect that is known.
    """
    for name, text in files.items():
        stem, _, ending = name.rpartition(".")
        match ending:
            case "st":
                return text
            case "TcPOU":
                return _from_tcpou(text)
            case "xml":
                return _from_plcopen(stem, text)
            case "scl":
                return _from_scl(text)
            case "L5X":
                return _from_l5x(stem, text)
            case "c":
                return _from_c(stem, files[f"{stem}.h"], text)
    raise ParameterError.expected("a file of an exported block", list(files), "pass what export() returned")


def _assemble(name: str, declarations: Iterable[Declaration], body: str) -> str:
    lines = [f"FUNCTION_BLOCK {name}"]
    declared = list(declarations)
    for word in ("VAR_INPUT", "VAR_OUTPUT", "VAR"):
        lines.append(word)
        for section, variable, kind, default in declared:
            if section == word:
                lines.append(f"    {variable} : {kind}{f' := {default}' if default else ''};")
        lines.append("END_VAR")
    return "\n".join([*lines, body, "END_FUNCTION_BLOCK", ""])


def _from_tcpou(text: str) -> str:
    pou = ET.fromstring(text.encode()).find("POU")  # noqa: S314  our own file
    assert pou is not None  # noqa: S101
    return f"{pou.findtext('Declaration')}\n{pou.findtext('Implementation/ST')}\nEND_FUNCTION_BLOCK\n"


def _from_plcopen(name: str, text: str) -> str:
    root = ET.fromstring(text.encode())  # noqa: S314  our own file
    declarations = []
    for element, word in (("inputVars", "VAR_INPUT"), ("outputVars", "VAR_OUTPUT"), ("localVars", "VAR")):
        for variable in root.iterfind(f".//{TC6}{element}/{TC6}variable"):
            kind = next(iter(variable.find(f"{TC6}type") or ())).tag.removeprefix(TC6)
            simple = variable.find(f"{TC6}initialValue/{TC6}simpleValue")
            default = "" if simple is None else simple.attrib["value"]
            declarations.append((word, variable.attrib["name"], kind, default))
    return _assemble(name, declarations, root.findtext(f".//{TC6}ST/{XHTML}p") or "")


def _from_scl(text: str) -> str:
    text = re.sub(r"\bREAL#", "REAL@", text)
    text = re.sub(r"^\{ S7.*\}$|^VERSION.*$|^BEGIN$|\bIN[12] := |#", "", text, flags=re.MULTILINE)
    text = text.replace("REAL@", "REAL#").replace("VAR_TEMP", "VAR")
    text = re.sub(r'^FUNCTION_BLOCK "(\w+)"', r"FUNCTION_BLOCK \1", text, flags=re.MULTILINE)
    return re.sub(r": (LReal|Real|Bool|DInt)\b", lambda found: f": {found[1].upper()}", text)


def _from_l5x(name: str, text: str) -> str:
    root = ET.fromstring(text.encode())  # noqa: S314  our own file
    declarations: list[Declaration] = []
    for tag in [*root.iterfind(".//Parameter"), *root.iterfind(".//LocalTag")]:
        if tag.attrib["Name"] in ("EnableIn", "EnableOut"):
            continue
        word = {"Input": "VAR_INPUT", "Output": "VAR_OUTPUT"}.get(tag.attrib.get("Usage", ""), "VAR")
        kind, default = tag.attrib["DataType"], (tag.findtext("DefaultData") or "").strip()
        if kind == "BOOL":
            default = {"0": "FALSE", "1": "TRUE"}[default]
        declarations.append((word, tag.attrib["Name"], kind, default))
    lines = [line.text or "" for line in root.iterfind(".//Routine[@Name='Logic']//Line")]
    types = {variable: kind for _, variable, kind, _ in declarations}
    return _assemble(name, declarations, "\n".join(_explicit(line, types) for line in lines))


def _explicit(line: str, types: dict[str, str]) -> str:
    """Logix assignment with the conversions that it does by itself written out."""
    found = re.fullmatch(r"(\s*)(\w+) := (.*);", line)
    if not found:
        return line
    pad, target, value = found.groups()
    kind = types[target]
    if kind == "BOOL" and value in ("0", "1"):
        value = "TRUE" if value == "1" else "FALSE"
    source = types.get(value, kind)
    if "DINT" in (kind, source) and kind != source:
        value = f"{source}_TO_{kind}({value})"
    return f"{pad}{target} := {value};"


def _from_c(name: str, header: str, text: str) -> str:
    words = {"parameters": "VAR_INPUT", "inputs": "VAR_INPUT", "outputs": "VAR_OUTPUT", "state": "VAR"}
    defaults = re.findall(r"([^\s,{]+), /\* (\w+) \*/", text)
    known = {variable: value for value, variable in defaults}
    declarations: list[Declaration] = []
    for block, struct in re.findall(
        r"typedef struct \{\n(.*?)\} \w+?_(parameters|inputs|outputs|state);", header, re.S
    ):
        for kind, variable in re.findall(r"^ +(\w+) (\w+);", block, re.M):
            default = (
                re.sub(r"(?<=\d)f$", "", known.get(variable, "")).replace("true", "TRUE").replace("false", "FALSE")
            )
            declarations.append((words[struct], variable, C_TYPES[kind], default))
    body = text[text.index("_step(") :].split("{\n", 1)[1].rsplit("}", 1)[0]
    real = "LREAL" if "double" in header else "REAL"
    return _assemble(name, declarations, "\n".join(_c_line(line, real) for line in body.splitlines()))


def _c_line(line: str, real: str) -> str:
    line = re.sub(r"^(\s*)/\* (.*) \*/$", r"\1(* \2 *)", line)
    if line.lstrip().startswith("(*"):
        return line
    line = re.sub(r"^(\s*)\} else if \((.*)\) \{$", r"\1ELSIF \2 THEN", line)
    line = re.sub(r"^(\s*)if \((.*)\) \{$", r"\1IF \2 THEN", line)
    line = re.sub(r"^(\s*)\} else \{$", r"\1ELSE", line)
    line = re.sub(r"^(\s*)\}$", r"\1END_IF;", line)
    line = re.sub(r"[psio]->", "", line)
    line = line.replace("(double)", "DINT_TO_LREAL").replace("(float)", "DINT_TO_REAL")
    line = line.replace("(int32_t)", f"{real}_TO_DINT")
    line = line.replace("lesser(", "MIN(").replace("greater(", "MAX(")
    line = re.sub(r"\bfabsf?\(", "ABS(", line)
    line = re.sub(r"(?<=\d)f\b", "", line)
    line = re.sub(r"\btrue\b", "TRUE", re.sub(r"\bfalse\b", "FALSE", line))
    line = re.sub(r"!(?!=)", "NOT ", line)
    line = re.sub(r"(?<=\w) = ", " := ", line)
    return line.replace("&&", "AND").replace("||", "OR").replace("==", "=").replace("!=", "<>")
