"""One element of SVG or HTML, everything escaped."""

from __future__ import annotations

import re
from functools import cache

from markupsafe import Markup, escape

PLAIN = re.compile(r"[\w .,:;%#()/+-]*", re.ASCII).fullmatch  # nothing in it has a meaning in HTML


def element(name: str, *children: str | Markup, **attributes: object) -> Markup:
    """Element with its children; texts and attributes are escaped, what is Markup already is not.

    Attributes end with "_" where Python has the word, and have "_" for "-"; None is left out.

    Examples
    --------
    >>> str(element("text", "<a>", x=1.50, text_anchor="end", class_='"x"', y=None))
    '<text x="1.5" text-anchor="end" class="&#34;x&#34;">&lt;a&gt;</text>'
    """
    said = "".join(f' {_name(key)}="{_text(value)}"' for key, value in attributes.items() if value is not None)
    inside = "".join(map(escape, children))
    return Markup(f"<{name}{said}>{inside}</{name}>")  # noqa: S704  everything in it is escaped


@cache
def _name(key: str) -> str:
    return key.rstrip("_").replace("_", "-")


def _text(value: object) -> str:
    """A page has thousands of them, most of them numbers and words that nothing needs to be escaped in."""
    text = short(value)
    if isinstance(text, str):
        return text if PLAIN(text) else escape(text)
    return str(text) if isinstance(text, int) else escape(text)


def short(value: object) -> object:
    """Numbers with as many digits as a screen has."""
    return f"{value:.2f}".rstrip("0").rstrip(".") if isinstance(value, float) else value


def percent(share: float) -> str:
    """Length as a share of what it lies in.

    Examples
    --------
    >>> percent(0.12345)
    '12.35%'
    """
    return f"{short(100.0 * share)}%"
