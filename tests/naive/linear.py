"""Difference equation and stability."""

import numpy as np


def simulate(a, b, delay, x, forcing=None):
    """y(k) = sum b_i x(k-d-i) - sum a_j y(k-j) + forcing(k), with zeros before the first sample."""
    x = list(x)
    y = []
    for k in range(len(x)):
        value = sum(b[i] * x[k - delay - i] for i in range(len(b)) if k - delay - i >= 0)
        value -= sum(a[j - 1] * y[k - j] for j in range(1, len(a) + 1) if k - j >= 0)
        if forcing is not None and k < len(forcing):
            value += forcing[k]
        y.append(value)
    return np.array(y)


def largest_root(a):
    """Largest modulus of the roots of z^n + a1 z^(n-1) + .. + an; 0 without roots."""
    return max((abs(root) for root in np.roots([1.0, *a])), default=0.0)
