"""What a watch takes from a fit: orders, noise order and gain, and only of a dead zone."""

from __future__ import annotations

from typing import Any

from lostmotion.compensate.gate import Said, pass_dead_zone
from lostmotion.errors import ParameterError
from lostmotion.identify import RatedEstimate
from lostmotion.identify.likelihood.noise_order import MOST_NOISE_LAGS

WAY_OUT = (
    "no other kind is watched yet: identify a new record from time to time, `lostmotion identify FILE --out NEW.json`, "
    "and compare the sizes"
)


def settings_from_fit(
    fit: RatedEstimate, diagnosis: Said | None = None, accept: str | None = None
) -> tuple[dict[str, Any], str]:
    """Settings of the estimator that watches the loop of a fit.

    Parameters
    ----------
    fit : HammersteinFit or FitFacts
        Of a dead zone; its size need not be known.
    diagnosis : Diagnosis, its dictionary or its verdict, optional
        Of the same loop: it must name the dead zone.
    accept : str, optional
        Reason for which a closed gate is passed all the same.

    Returns
    -------
    (dict, str)
        na, nb, delay, noise, gain for ``RecursiveML``; what was accepted, empty where the gate was open.

    Raises
    ------
    GateError
        The fit is of another kind, or shows no dead zone, or the diagnosis says something else.
    """
    facts = fit.facts
    accepted = pass_dead_zone(facts, diagnosis, accept, WAY_OUT)
    linear = facts.linear
    orders = {"na": len(linear.a), "nb": len(linear.b) - 1, "delay": linear.delay}
    return {**orders, "noise": facts.noise.autoregression(MOST_NOISE_LAGS).order, "gain": facts.known_gain}, accepted


def watched_model(
    fit: RatedEstimate | None,
    orders: tuple[int, int, int] | None,
    gain: float | None = None,
    noise: str | int = "auto",
    diagnosis: Said | None = None,
    accept: str | None = None,
) -> tuple[dict[str, Any], str]:
    """Settings of the estimator: what is said goes before what the fit says; and what was accepted to get them.

    Raises
    ------
    ParameterError
        Neither orders nor a fit.
    GateError
        As :func:`settings_from_fit`.
    """
    if orders is None and fit is None:
        raise ParameterError.expected("orders or a fit", "neither", "give na, nb and delay, such as 3, 2, 3")
    model: dict[str, Any] = {"gain": gain, "noise": noise}
    accepted = ""
    if fit is not None:
        found, accepted = settings_from_fit(fit, diagnosis, accept)
        known = {name: model[name] for name, given in (("gain", gain is not None), ("noise", noise != "auto")) if given}
        model = found | known
    if orders is not None:
        model |= dict(zip(("na", "nb", "delay"), orders, strict=True))
    return model, accepted
