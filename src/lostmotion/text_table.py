"""A table of plain text: columns of given widths under a head."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def text_table(head: Sequence[str], widths: Sequence[int], rows: Iterable[Sequence[str]]) -> list[str]:
    r"""Lines of a table; none where there are no rows.

    Examples
    --------
    >>> print(*text_table(("loop", "dt"), (8, 4), [("FIC-101", "1"), ("LIC-7", "0.1")]), sep="\n")
    loop     dt
    -----------
    FIC-101  1
    LIC-7    0.1
    """
    lines = [_joined(cells, widths) for cells in rows]
    top = _joined(head, widths)
    return [top, "-" * len(top), *lines] if lines else []


def _joined(cells: Sequence[str], widths: Sequence[int]) -> str:
    return " ".join(f"{cell:{width}}" for cell, width in zip(cells, widths, strict=True)).rstrip()
