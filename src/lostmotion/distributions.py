"""Quantiles and tails of the usual distributions, from scipy.special: scipy.stats takes over a second to import."""

from __future__ import annotations

from scipy import special


def normal_quantile(probability: float) -> float:
    """Quantile of the standard normal distribution.

    Examples
    --------
    >>> round(normal_quantile(0.975), 4)
    1.96
    """
    return float(special.ndtri(probability))


def chi2_quantile(probability: float, freedom: int) -> float:
    """Quantile of chi-squared.

    Examples
    --------
    >>> round(chi2_quantile(0.95, 1), 4)
    3.8415
    """
    return float(2.0 * special.gammaincinv(0.5 * freedom, probability))


def chi2_tail(value: float, freedom: int) -> float:
    """Probability that chi-squared exceeds a value.

    Examples
    --------
    >>> round(chi2_tail(3.8415, 1), 4)
    0.05
    """
    return float(special.chdtrc(freedom, value))


def f_tail(value: float, above: int, below: int) -> float:
    """Probability that F with so many degrees of freedom above and below exceeds a value.

    Examples
    --------
    >>> round(f_tail(3.0, 3, 100), 4)
    0.0342
    """
    return float(special.fdtrc(above, below, value))
