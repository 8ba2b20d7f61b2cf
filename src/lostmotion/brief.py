"""Results that are shown in one line: type and finding; the whole text is their summary."""

from __future__ import annotations


class Brief:
    """Base of results with a repr of one line; dataclasses of it are made with ``repr=False``.

    Examples
    --------
    >>> class Found(Brief):
    ...     def repr_parts(self):
    ...         return "backlash", f"size {between(1.0, 2.0)}"
    >>> Found()
    Found(backlash, size 1..2)
    """

    def repr_parts(self) -> tuple[str, ...]:
        """Finding in a few words each; empty ones are left out."""
        return ()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(part for part in self.repr_parts() if part)})"


def between(low: float, high: float) -> str:
    """Interval in four digits."""
    return f"{low:.4g}..{high:.4g}"


def counted(count: int, what: str) -> str:
    """Number with its noun.

    Examples
    --------
    >>> counted(1, "piece"), counted(2, "piece")
    ('1 piece', '2 pieces')
    """
    return f"{count} {what}{'' if count == 1 else 's'}"
