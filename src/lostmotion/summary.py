"""Text of a result that can also be had as a table, as HTML and as LaTeX."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

from lostmotion import _verbs


class Summary(str):
    """Report as text, which a console shows as it is; a notebook shows its table.

    Examples
    --------
    >>> import lostmotion as lm
    >>> summary = lm.check(lm.datasets.load("FIC-102")).summary()
    >>> summary.splitlines()[-1]
    '  usable'
    >>> list(summary.to_frame().columns)
    ['level', 'what', 'why', 'remedy']
    """

    __slots__ = ("_result",)
    _result: Any

    def __new__(cls, text: str, result: Any) -> Self:
        """Text, and the result whose it is."""
        summary = super().__new__(cls, text)
        summary._result = result
        return summary

    def __reduce__(self) -> tuple[Any, ...]:
        return str, (str(self),)  # what is sent elsewhere is the text

    def __repr__(self) -> str:
        return str(self)

    def to_frame(self) -> Any:
        """Return the table with numbers, as a pandas frame where pandas is installed, else as a Polars frame."""
        table = _verbs.frame(self._result)
        columns = table if isinstance(table, Mapping) else table.to_dict(as_series=False)
        try:
            import pandas as pd  # noqa: PLC0415  not required
        except ImportError:
            import polars as pl  # noqa: PLC0415  heavy

            return pl.DataFrame(columns)
        return pd.DataFrame(columns)

    def to_html(self) -> str:
        """Return headline and tables as HTML, without colours."""
        return _verbs.panel(self._result).html()

    def to_latex(self) -> str:
        """Return headline and tables as a LaTeX float, which needs no package."""
        return _verbs.panel(self._result).latex()

    def _repr_html_(self) -> str:
        return self.to_html()
