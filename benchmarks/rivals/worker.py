"""Run one rival: ``python worker.py NAME IN.npz OUT.npz``, inside the rivals' own environment.

IN holds u, y (seeds, n) and fresh (m,); OUT gets zone (seeds, 3: left, right, slope ratio), seconds (seeds,) and
simulated (seeds, m). NAME "yardstick" gives the seconds of one bare padasip step.
"""

from __future__ import annotations

import importlib
import sys
import time
import warnings

import numpy as np

RIVALS = {
    "padasip key-term": ("padasip_rls", "fit_key_term"),
    "padasip hinges": ("padasip_rls", "fit_hinges"),
    "filterpy": ("unscented", "fit"),
    "least_squares": ("least_squares", "fit"),
    "jax-sysid": ("jax_model", "fit"),
    "yardstick": ("padasip_rls", "seconds_per_step"),
}


def main(name: str, source: str, target: str) -> None:
    module, function = RIVALS[name]
    work = getattr(importlib.import_module(module), function)
    warnings.simplefilter("ignore")  # of a diverging rival; its figures tell
    with np.load(source) as data:
        u, y, fresh = data["u"], data["y"], data["fresh"]
    if name == "yardstick":
        np.savez(target, seconds=[work(*pair) for pair in zip(u, y, strict=True)])
        return
    zone, seconds, simulated = [], [], []
    for pair in zip(u, y, strict=True):
        begin = time.process_time()
        found = work(*pair)
        seconds.append(time.process_time() - begin)
        zone.append([found.left, found.right, found.ratio])
        simulated.append(found.simulate(fresh))
    np.savez(target, zone=zone, seconds=seconds, simulated=simulated)


if __name__ == "__main__":
    main(*sys.argv[1:])
