"""A supervisor and an operator who do everything wrong that can be done, laid over the scans of a scenario."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from lostmotion.compensate import Specification
from lostmotion.compensate.request import LARGEST, Request
from lostmotion.compensate.supervised import SupervisedSpecification

COUNTS = {"TIMEOUT": (4, 8, 20), "SHOW_SCANS": (1, 2, 3), "ACCEPT_SCANS": (6, 12, 30), "LEAST_SCANS": (0, 0, 3, 12)}
CALM = {"GOOD": 1.0, "TRACK": 0.0, "AUTO_MODE": 1.0, "CASCADE": 1.0, "ENABLE": 1.0}
ODD_NUMBERS = (-1, LARGEST + 1, 2**30, -(2**30), 16_777_217)
CHANGED = ("asked_factor", "asked_first", "asked_second", "checksum")
FAULTS = ("checksum", "old id", "id", "range", "half", "number", "key")
SMALLEST = 1e-9  # resolution
GOOD_SHARE, CALM_SHARE, ASK_SHARE = 0.75, 0.75, 0.2
Array = npt.NDArray[np.floating[Any]]


@dataclass
class Script:
    """What supervisor and operator write, scan by scan; `columns` are those of the block."""

    random: np.random.Generator
    columns: dict[str, int]
    tame: bool
    id: int = 0
    beat: int = 0
    wait: int = 0
    written: dict[str, int] = field(default_factory=dict)
    later: dict[str, int] = field(default_factory=dict)
    pressed: bool = False

    def row(self, row: Array, settings: dict[str, float], names: tuple[str, str], frozen: bool) -> None:
        """Fill the inputs of one scan."""
        self._beat(frozen)
        self.written.update(self.later)
        self.later = {}
        self.pressed = False
        if self.wait > 0:
            self.wait -= 1
            if self.wait == 0:
                self._answer()
        elif self.random.random() < ASK_SHARE:
            self._ask(settings, names)
        for name, value in self.written.items():
            row[self.columns[name.upper()]] = value
        row[self.columns["HEARTBEAT"]] = self.beat
        row[self.columns["ACCEPT"]] = self.pressed or (not self.tame and self.random.random() < 0.02)

    def _beat(self, frozen: bool) -> None:
        if not frozen and self.random.random() < 0.6:
            self.beat = (self.beat + 1) % LARGEST
        elif not self.tame and self.random.random() < 0.02:
            self.beat = int(self.random.choice(ODD_NUMBERS))

    def _ask(self, settings: dict[str, float], names: tuple[str, str]) -> None:
        """Write a request, as it should be or wrong."""
        self.id += int(self.random.integers(1, 4))
        unit = settings["resolution"] if SMALLEST < settings["resolution"] < np.inf else 1.0
        shares = self.random.uniform(-0.5, 0.5, size=2)
        widths = []
        for name, near, share in zip(names, ("first_range", "second_range"), shares, strict=True):
            reach = min(settings[near], settings["most_change"])
            widths.append(_whole(settings.get(name, 0.0) + float(share) * reach, unit))
        factor = settings["factor"] * (1.0, 0.9, 0.5)[int(self.random.integers(3))]
        request = Request(self.id, _whole(factor, unit), widths[0], widths[1], _key(settings))
        fault = None if self.random.random() < GOOD_SHARE else FAULTS[int(self.random.integers(len(FAULTS)))]
        self.written = _spoil(dict(request.values), fault, self)
        self.wait = 1 + int(settings["show_scans"] if 0 <= settings["show_scans"] < 100 else 2)
        self.wait += int(self.random.integers(-1, 3))
        self.wait = max(self.wait, 1)

    def _answer(self) -> None:
        """Accept mostly; else withdraw, change what is shown, or say nothing."""
        chance = self.random.random()
        if chance < 0.8:
            self.pressed = True
        elif chance < 0.87:
            self.written["request_id"] = 0
        elif chance < 0.94:
            name = CHANGED[int(self.random.integers(len(CHANGED)))]
            self.written[name] = self.written.get(name, 0) + 1


def _whole(value: float, unit: float) -> int:
    """Whole units, towards 0, as far as a request can hold them; 0 for what is no number."""
    most = LARGEST * unit
    return int(min(max(value, -most), most) / unit + 1e-9) if math.isfinite(value) else 0


def _key(settings: dict[str, float]) -> int:
    return int(settings["block_key"]) if 0 <= settings["block_key"] < 524287 else 0


def _spoil(values: dict[str, int], fault: str | None, script: Script) -> dict[str, int]:
    """The request with one thing wrong."""
    random = script.random
    if fault == "checksum":
        values["checksum"] += int(random.choice((-1, 1, 31, 524287)))
    elif fault == "old id":
        script.id = max(script.id - 9, 0)
        values["request_id"] = script.id
    elif fault == "id":
        values["request_id"] = int(random.choice(ODD_NUMBERS))
    elif fault == "range":
        values["asked_first"] = int(random.choice((-LARGEST, LARGEST, -values["asked_first"])))
    elif fault == "number":
        name = CHANGED[int(random.integers(len(CHANGED)))]
        values[name] = int(random.choice(ODD_NUMBERS))
    elif fault == "key":
        values["checksum"] = (values["checksum"] + 31**4) % 524287
    elif fault == "half":  # the id comes before some of what it stands for
        names = list(values)[: int(random.integers(1, 4))]
        script.later = {name: values[name] for name in names}
        values.update({name: script.written.get(name, 0) for name in names})
    return values


def supervise_scans(
    specification: Specification, stretches: Sequence[Any], random: np.random.Generator, *, tame: bool
) -> None:
    """Overwrite the inputs of the supervision in all stretches, and the counts in their settings where not `tame`."""
    assert isinstance(specification, SupervisedSpecification)  # noqa: S101
    columns = {variable.name: k for k, variable in enumerate(specification.section("input"))}
    places = {variable.name: k for k, variable in enumerate(specification.section("parameter"))}
    script = Script(random, columns, tame)
    counts: dict[str, float] = {}
    for stretch in stretches:
        if not tame and (not counts or random.random() < 0.1):
            counts = {name: float(random.choice(options)) for name, options in COUNTS.items()}
        if random.random() < 0.9:
            for name, value in counts.items():
                stretch.parameters[places[name]] = value
        if random.random() < CALM_SHARE:
            for name, usual in CALM.items():
                stretch.inputs[:, columns[name]] = usual
        frozen = random.random() < (0.05 if tame else 0.1)
        settings = {name.lower(): float(stretch.parameters[k]) for name, k in places.items()}
        for row in stretch.inputs:
            script.row(row, settings, (specification.first, specification.second), frozen)
