"""What a watch takes from a fit: orders, noise order and gain, and only of a dead zone."""

from __future__ import annotations

from typing import Any

from lostmotion.compensate.gate import Said, pass_dead_zone
from lostmotion.identify import RatedEstimate

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
    return {**orders, "noise": facts.noise.order, "gain": facts.known_gain}, accepted
