"""Declarations and file frames, by templates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import jinja2
from markupsafe import Markup

from lostmotion.export.names import plc_names
from lostmotion.export.source import Source
from lostmotion.export.tree import Block, Name

SECTIONS = ("input", "parameter", "output", "state")


@dataclass(frozen=True)
class Row:
    """One declaration: name, type and default as the dialect writes them, unit and meaning for people."""

    name: str
    type: str
    default: str
    kind: str
    meaning: str


@dataclass(frozen=True)
class Declared:
    """Names and declarations of a block in one dialect."""

    names: Mapping[Name, str]
    rows: Mapping[str, list[Row]]


def declare(
    source: Source, block: Block, types: Mapping[str, str], true: str = "TRUE", false: str = "FALSE"
) -> Declared:
    """Declarations of all variables; `types` maps the kinds to types of the dialect."""
    every = [variable for section in SECTIONS for variable in source.variables(section)]
    names = plc_names([*every, *block.local_names], taken=[source.name])
    rows: dict[str, list[Row]] = {"local": []}
    for section in SECTIONS:
        rows[section] = []
        for variable in source.specification.section(section):
            name = names[Name(section, variable.name, variable.kind)]
            value = source.values[variable.name.lower()] if section == "parameter" else variable.default
            default = source.constant(variable.kind, value, true, false)
            unit = f"{variable.unit}: " if variable.unit else ""
            row = Row(name, types[variable.kind], default, variable.kind, unit + variable.meaning)
            rows[section].append(row)
    for local in block.local_names:
        default = source.constant(local.kind, 0.0, true, false)
        rows["local"].append(Row(names[local], types[local.kind], default, local.kind, "scratch, fresh in each scan"))
    return Declared(names, rows)


@cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("lostmotion.export"),
        autoescape=jinja2.select_autoescape(("xml.j2",), default=False),
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["cdata"] = _cdata
    return environment


def _cdata(text: str) -> Markup:
    """A CDATA section, which nothing inside it can end."""
    inside = str(text).replace("]]>", "]]]]><![CDATA[>")
    return Markup(f"<![CDATA[{inside}]]>")  # noqa: S704  what it holds is data


def render(template: str, **context: Any) -> str:
    """Text of a template."""
    return _environment().get_template(template).render(**context)
