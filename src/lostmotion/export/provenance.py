"""What the header says about the fit that the settings come from."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SHOWN = ("left", "right", "width", "slope_ratio", "band", "jump")


def provenance(fit: Mapping[str, Any]) -> dict[str, str]:
    """Lines "data", "fit" and "interval" from the dictionary of a fit (``HammersteinFit.to_dict``)."""
    data = fit["data"]
    numbers = {name: value for name, value in fit["parameters"].items() if name in SHOWN and value is not None}
    ends = fit["intervals_95"]
    known = {name: ends[name] for name in numbers if name in ends and None not in ends[name]}
    return {
        "data": f"{data['source'] or data['tag'] or 'arrays'}, {data['samples']} samples of {data['dt']:g} s, "
        f"fingerprint {data['fingerprint']}",
        "fit": f"{fit['preferred']}, status {fit['status']}: "
        + ", ".join(f"{name} {value:.6g}" for name, value in numbers.items()),
        "interval": "95 %: " + ", ".join(f"{name} {low:.6g} .. {high:.6g}" for name, (low, high) in known.items()),
    }
