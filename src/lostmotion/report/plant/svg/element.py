"""One element of SVG or HTML, everything escaped."""

from __future__ import annotations

from markupsafe import Markup, escape


def element(name: str, *children: str | Markup, **attributes: object) -> Markup:
    """Element with its children; texts and attributes are escaped, what is Markup already is not.

    Attributes end with "_" where Python has the word, and have "_" for "-"; None is left out.

    Examples
    --------
    >>> str(element("text", "<a>", x=1.50, text_anchor="end", class_='"x"', y=None))
    '<text x="1.5" text-anchor="end" class="&#34;x&#34;">&lt;a&gt;</text>'
    """
    said = "".join(
        f' {key.rstrip("_").replace("_", "-")}="{escape(short(value))}"'
        for key, value in attributes.items()
        if value is not None
    )
    inside = "".join(map(escape, children))
    return Markup(f"<{name}{said}>{inside}</{name}>")  # noqa: S704  everything in it is escaped


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
