"""Four or eight floats at once: what loops are made of that a compiler would not vectorise, or not as wide as it could.

A compiler does not vectorise loops over a dozen floats whose number and overlap it cannot know. These functions say it
outright: a quad, or an octet, is a vector register (or two of half the width). Their Python bodies are their meaning
and run with the JIT off; there a quad is an array (4,), an octet one of (8,). Indices are not checked, and only whole
quads are moved.
"""

from __future__ import annotations

from typing import TypeAlias, TypeVar

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.kernels import lanes_llvm as machine
from lostmotion.kernels.numba_cache import njit

Quad: TypeAlias = FloatArray
Octet: TypeAlias = FloatArray
AnyArray = TypeVar("AnyArray", FloatArray, IntArray)
WIDTH, EIGHT, WIDEST = machine.WIDTH, machine.EIGHT, machine.WIDEST


@machine.as_address
def address(array: AnyArray) -> AnyArray:
    """Where an array begins: indexed like the array, without bounds and without counted references.

    In compiled code it lives as long as the array does; the counting would cost more than the arithmetic. Compiled code
    frees an array behind its last use by name, so that an array of the function itself is kept by ``alive`` (and what a
    function is given that is inlined).
    """
    return array


@machine.as_alive
def alive(arrays: AnyArray | tuple[FloatArray | IntArray, ...]) -> None:
    """Keep an array, or several, up to here: its address was in use."""


@machine.as_widest
def widest() -> None:
    """Loops of the function that calls it may use the widest registers there are, which compilers shun."""


@machine.as_load
def load(floats: FloatArray, at: int) -> Quad:
    """Four neighbours from `at` on."""
    return floats[at : at + WIDTH].copy()


@machine.as_load_eight
def load_eight(floats: FloatArray, at: int) -> Octet:
    """Eight neighbours from `at` on."""
    return floats[at : at + EIGHT].copy()


@machine.as_store
def store(floats: FloatArray, at: int, values: Quad) -> None:
    """Write neighbours from `at` on, as many as there are values."""
    floats[at : at + values.size] = values


@machine.as_spread
def spread(value: float) -> Quad:
    """The same float four times."""
    return np.full(WIDTH, value)


@machine.as_spread_eight
def spread_eight(value: float) -> Octet:
    """The same float eight times."""
    return np.full(EIGHT, value)


@machine.as_newest
def newest(values: Octet) -> Octet:
    """The last of eight, eight times."""
    return np.full(EIGHT, values[-1])


@machine.as_second_newest
def second_newest(values: Octet) -> Octet:
    """The last but one, eight times."""
    return np.full(EIGHT, values[-2])


@machine.as_third_newest
def third_newest(values: Octet) -> Octet:
    """The one before that, eight times."""
    return np.full(EIGHT, values[-3])


@machine.as_product
def times(one: Quad, other: Quad) -> Quad:
    """Products of equal places."""
    return one * other


@machine.as_quotient
def over(one: Quad, other: Quad) -> Quad:
    """Quotients of equal places."""
    return one / other


@machine.as_difference
def less(one: Quad, other: Quad) -> Quad:
    """Differences of equal places."""
    return one - other


@machine.as_choice
def where_above(left: Quad, right: Quad, one: Quad, other: Quad) -> Quad:
    """`one` where `left` is above `right`, else `other`."""
    return np.where(left > right, one, other)


@machine.as_whole
def whole(values: Quad) -> Quad:
    """Greatest whole numbers not above."""
    return np.floor(values)


@machine.as_root_above
def root_above(left: Quad, floor: Quad) -> Quad:
    """Roots of what is above a floor; infinite elsewhere."""
    return np.sqrt(np.where(left > floor, left, np.inf))


@machine.as_fused
def plus_product(start: Quad, one: Quad, other: Quad) -> Quad:
    """`start` + `one` * `other`, rounded once where the processor can."""
    return start + one * other


@machine.as_total
def total(values: Quad) -> float:
    """Sum of the four."""
    return float((values[0] + values[2]) + (values[1] + values[3]))


@njit(nogil=True, forceinline=True)
def dot(floats: FloatArray, one: int, other: int, size: int) -> float:
    """Inner product of two padded rows that begin at `one` and `other`."""
    values = spread(0.0)
    for j in range(0, size, WIDTH):
        values = plus_product(values, load(floats, one + j), load(floats, other + j))
    return total(values)


# As many as a register holds, four or eight: where the code does not say how many. A processor that has none of eight
# has few of four, and spends its time to move them.
load_widest = load_eight if WIDEST == EIGHT else load
spread_widest = spread_eight if WIDEST == EIGHT else spread
