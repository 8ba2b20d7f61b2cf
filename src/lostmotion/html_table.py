"""Tables and sentences for notebooks: every text escaped, colours left to the notebook, so that light and dark do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from lostmotion.printable import printable

LEFT = ' style="text-align:left;vertical-align:top"'


def html_table(rows: Iterable[Sequence[str]], head: Sequence[str] = (), named: bool = False) -> str:
    """Table with an optional head; nothing where there are no rows.

    Parameters
    ----------
    rows : iterable of sequence of str
    head : sequence of str
    named : bool
        The first cell of a row is its name.

    Examples
    --------
    >>> html_table([("FIC-1", "<b>")], named=True).replace(LEFT, "")
    '<table><tr><th>FIC-1</th><td>&lt;b&gt;</td></tr></table>'
    """
    lines = [_row(cells, 1 if named else 0) for cells in rows]
    top = [_row(head, len(head))] if head else []
    return f"<table>{''.join([*top, *lines])}</table>" if lines else ""


def html_panel(headline: str, *parts: str, said: Sequence[str] = ()) -> str:
    """Headline in bold, sentences, then parts that are HTML already.

    Examples
    --------
    >>> html_panel("a < b", "<table></table>", said=("& more",))
    '<div><p><b>a &lt; b</b></p><p>&amp; more</p><table></table></div>'
    """
    sentences = "".join(f"<p>{_text(text)}</p>" for text in said if text)
    return f"<div><p><b>{_text(headline)}</b></p>{sentences}{''.join(parts)}</div>"


def html_list(texts: Iterable[str]) -> str:
    """List of sentences; nothing where there are none.

    Examples
    --------
    >>> html_list(["x > 1"])
    '<ul><li>x &gt; 1</li></ul>'
    """
    items = "".join(f"<li>{_text(text)}</li>" for text in texts)
    return f"<ul>{items}</ul>" if items else ""


def _row(cells: Sequence[str], names: int) -> str:
    """Cells, the first `names` of them as headings."""
    tags = ["th"] * names + ["td"] * (len(cells) - names)
    inside = (f"<{tag}{LEFT}>{_text(cell)}</{tag}>" for tag, cell in zip(tags, cells, strict=True))
    return f"<tr>{''.join(inside)}</tr>"


def _text(text: str) -> str:
    return escape(printable(text))
