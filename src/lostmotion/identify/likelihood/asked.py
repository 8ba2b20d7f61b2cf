"""What is asked of a search: orders, noise, and whether the process may integrate."""

from __future__ import annotations

from dataclasses import dataclass

DEFAULT_ORDERS = (3, 2, 1)  # whose number of samples a search over all orders needs


@dataclass(frozen=True)
class Asked:
    """Orders and noise that were given, or are to be found.

    Attributes
    ----------
    orders : (na, nb, delay) or None
        None: chosen from the data.
    noise : int or None
        Order of the AR noise; None: chosen from the data.
    integrating : bool or None
        Whether the process integrates; None: chosen from the data.
    zero : bool
        Whether the noise may have a zero, where its order is chosen.
    """

    orders: tuple[int, int, int] | None = None
    noise: int | None = None
    integrating: bool | None = None
    zero: bool = True

    @property
    def any_noise(self) -> bool:
        """Whether a zero of the noise is to be sought."""
        return self.zero and self.noise is None

    @property
    def needed(self) -> int:
        """Samples that every segment must have."""
        return 3 * (sum(self.orders or DEFAULT_ORDERS) + (self.noise or 0)) + 30
