"""Result as headline, sentences and tables: the same for notebooks (HTML) and papers (LaTeX)."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from lostmotion.html_table import html_list, html_panel, html_table

ESCAPED = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "|": r"\textbar{}",
    **{sign: f"\\{sign}" for sign in "&%$#_{}"},
}
NUMBER = re.compile(r"[-+0-9.,e% ()]*|inf|-inf|-")


@dataclass(frozen=True)
class Table:
    """Cells of text, a head, and whether the first cell of a row is its name."""

    rows: Sequence[Sequence[str]]
    head: Sequence[str] = ()
    named: bool = True

    def latex(self) -> str:
        """As a ``tabular`` without packages; nothing where there are no rows."""
        if not self.rows:
            return ""
        columns = list(zip(*self.rows, strict=True))
        letters = ["r" if place and all(map(NUMBER.fullmatch, cells)) else "l" for place, cells in enumerate(columns)]
        top = [_line(self.head), r"\hline"] if self.head else []
        start, stop = rf"\begin{{tabular}}{{{''.join(letters)}}}", r"\end{tabular}"
        return "\n".join([start, r"\hline", *top, *map(_line, self.rows), r"\hline", stop])


@dataclass(frozen=True)
class Panel:
    r"""Headline, sentences, then tables and lists of sentences.

    Examples
    --------
    >>> panel = Panel("Found", Table([("width", "2.0")], ("", "%")), said=("A & B.",))
    >>> panel.html()  # doctest: +ELLIPSIS
    '<div><p><b>Found</b></p><p>A &amp; B.</p><table>...</table></div>'
    >>> print(panel.latex())
    \begin{table}
    \caption{Found}
    A \& B.
    <BLANKLINE>
    \begin{tabular}{lr}
    \hline
     & \% \\
    \hline
    width & 2.0 \\
    \hline
    \end{tabular}
    \end{table}
    """

    headline: str
    parts: tuple[Table | Sequence[str], ...]
    said: tuple[str, ...]

    def __init__(self, headline: str, *parts: Table | Sequence[str], said: Sequence[str] = ()) -> None:
        object.__setattr__(self, "headline", headline)
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "said", tuple(text for text in said if text))

    def html(self) -> str:
        """For notebooks: every text escaped, no colours."""
        parts = (
            html_table(part.rows, part.head, part.named) if isinstance(part, Table) else html_list(part)
            for part in self.parts
        )
        return html_panel(self.headline, *parts, said=self.said)

    def latex(self) -> str:
        """A float with a caption, in plain LaTeX."""
        parts = (part.latex() if isinstance(part, Table) else "\n\n".join(map(escaped, part)) for part in self.parts)
        inside = "\n\n".join(part for part in (*map(escaped, self.said), *parts) if part)
        return "\n".join([r"\begin{table}", rf"\caption{{{escaped(self.headline)}}}", inside, r"\end{table}"])


def escaped(text: str) -> str:
    r"""Text that LaTeX sets as it stands.

    Examples
    --------
    >>> print(escaped("5 % of B_1"))
    5 \% of B\_1
    """
    return "".join(ESCAPED.get(sign, sign) for sign in text)


def _line(cells: Sequence[str]) -> str:
    return " & ".join(map(escaped, cells)) + r" \\"
