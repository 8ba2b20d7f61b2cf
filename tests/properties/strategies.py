"""Random models for the property tests."""

import numpy as np
from hypothesis import strategies as st

from lostmotion.models import DeadZone, LinearModel

points = st.floats(-1e6, 1e6)
slopes = st.floats(-3, 3).map(lambda power: 10.0**power)
signals = st.lists(st.floats(-100, 100), min_size=1, max_size=30).map(np.array)


@st.composite
def dead_zones(draw):
    left, right = sorted((draw(points), draw(points)))
    return DeadZone(left, right, draw(slopes), draw(slopes))


@st.composite
def roots(draw, largest, most=4):
    """Real roots and conjugate pairs with moduli up to `largest`."""
    found = []
    for _ in range(draw(st.integers(0, most // 2))):
        size = draw(st.floats(0.01, largest))
        if draw(st.booleans()):
            root = size * np.exp(1j * draw(st.floats(0.1, 3.0)))
            found += [root, root.conjugate()]
        else:
            found.append(size * draw(st.sampled_from([-1.0, 1.0])))
    return np.array(found, dtype=complex)


def polynomial(zeros):
    """a1 .. an of the polynomial with these roots."""
    return np.real(np.poly(zeros))[1:] if len(zeros) else np.zeros(0)


@st.composite
def linear_models(draw, largest=0.9):
    """Stable models whose first and last b are not zero."""
    edge = st.floats(0.1, 10) | st.floats(-10, -0.1)
    inner = draw(st.lists(st.floats(-10, 10), max_size=2))
    b = [draw(edge), *inner, draw(edge)] if draw(st.booleans()) else [draw(edge)]
    return LinearModel(polynomial(draw(roots(largest))), b, draw(st.integers(0, 5)), draw(st.floats(1e-3, 1e3)))
