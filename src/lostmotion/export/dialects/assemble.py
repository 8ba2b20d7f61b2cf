"""IEC ST from declarations and a body, for dialects that keep the two apart."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

Declaration = tuple[str, str, str, str]  # word of the section, name, type, default or ""


def only_file(files: Mapping[str, str]) -> tuple[str, str]:
    """Name of the block and text of its one file."""
    ((name, text),) = files.items()
    return name.rpartition(".")[0], text


def assemble(name: str, declarations: Iterable[Declaration], body: str) -> str:
    """ST of a function block."""
    lines = [f"FUNCTION_BLOCK {name}"]
    declared = list(declarations)
    for word in ("VAR_INPUT", "VAR_OUTPUT", "VAR"):
        lines.append(word)
        for section, variable, kind, default in declared:
            if section == word:
                lines.append(f"    {variable} : {kind}{f' := {default}' if default else ''};")
        lines.append("END_VAR")
    return "\n".join([*lines, body, "END_FUNCTION_BLOCK", ""])
