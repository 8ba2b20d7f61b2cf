"""State of RecursiveML as bytes and back, bit by bit."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import numpy as np

from lostmotion.arrays import FloatArray, IntArray
from lostmotion.files.schema import parsed
from lostmotion.identify.recursive.archive import pack, reading
from lostmotion.identify.recursive.ml_recursion import Recursion
from lostmotion.identify.recursive.ml_settings import Settings
from lostmotion.identify.recursive.ml_start import FirstWindow
from lostmotion.identify.recursive.ml_stored import (
    check_header,
    check_recursion,
    check_scales,
    check_settings,
    check_window,
)
from lostmotion.identify.recursive.recursive_estimate import ChangeEvent
from lostmotion.kernels.recursive_ml import drift
from lostmotion.kernels.recursive_ml import state as ml

FORMAT = "lostmotion recursive ml 3"
SECOND_FORMAT = "lostmotion recursive ml 2"  # without what tells a stuck PV
FIRST_FORMAT = "lostmotion recursive ml 1"  # without what tells drift, colour and steps of OP; they begin anew


def packed(first: FirstWindow, recursion: Recursion | None) -> bytes:
    """Bytes of an estimator before its start (no recursion) or after it."""
    header = {
        "format": FORMAT,
        "settings": asdict(first.settings),
        "seen": first.seen if recursion is None else recursion.before,
        "next_try": first.next_try,
        "integrating": first.integrating,
        "events": [] if recursion is None else [asdict(event) for event in recursion.events],
    }
    return pack(
        header=np.frombuffer(json.dumps(header).encode(), dtype=np.uint8),
        gathered=np.array((first.u, first.y)),
        scales=np.array((1.0, 1.0) if recursion is None else recursion.scales),
        state=np.zeros(0) if recursion is None else recursion.state,
        layout=np.zeros(0, dtype=np.int64) if recursion is None else recursion.layout,
    )


def unpacked(data: bytes) -> tuple[FirstWindow, Recursion | None]:
    """First window and recursion from bytes; DataError where they are something else."""
    with reading(data) as parts:
        header = check_header(parsed(parts["header"].tobytes()))
        if header["format"] not in (FORMAT, SECOND_FORMAT, FIRST_FORMAT):
            raise ValueError(header["format"])
        return _restored(header, parts)


def _restored(header: dict[str, Any], parts: dict[str, Any]) -> tuple[FirstWindow, Recursion | None]:
    settings = Settings(**header["settings"])
    seen, gathered = header["seen"], parts["gathered"]
    check_settings(settings)
    check_window(gathered, settings, seen)
    check_scales(parts["scales"])
    events = [ChangeEvent(**event) for event in header["events"]]
    scales = (float(parts["scales"][0]), float(parts["scales"][1]))
    u, y = gathered.tolist()
    first = FirstWindow(settings, u, y, seen, header["next_try"], header.get("integrating", False))
    if not parts["state"].size:
        return first, None
    state, layout = np.ascontiguousarray(parts["state"]), np.ascontiguousarray(parts["layout"])
    if header["format"] != FORMAT:
        state, layout = _grown(settings, state, layout)
    check_recursion(settings, state, layout)
    if header["format"] == FIRST_FORMAT:
        drift.agree(state, layout)
    return first, Recursion(settings, state, layout, scales, seen, events)


def _grown(settings: Settings, state: FloatArray, layout: IntArray) -> tuple[FloatArray, IntArray]:
    if layout.dtype != np.int64 or state.dtype != np.float64 or layout.size <= ml.P:
        raise ValueError("layout")
    p = int(layout[ml.P])
    if not 0 <= p * p < state.size:
        raise ValueError("layout")
    return ml.grown(state, layout, settings.tuning.places(settings.orders, p))
