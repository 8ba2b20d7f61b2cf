"""Loops whose valve has no fault: what moves or disturbs them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

from published_loops import signals as of
from published_loops.case import Case, Course
from published_loops.faulty import COURSES
from published_loops.plants import PLANTS, Plant
from published_loops.process import lags
from published_loops.upstream import pv_of, stem_of
from published_loops.valves import He, Kano, Sound, Stenman

NOISE, TUNING, WAVES, SET_POINT, SENSOR, UPSTREAM, EDGES = (
    "well tuned, noise and load",
    "tuned too tight",
    "load with sines",
    "set point moves",
    "sensor or OP at its end",
    "load from a loop whose valve sticks",
    "load with steps, squares, triangles",
)
DELAYED = Plant("Hägglund 1995", lags(1, 10, dead_time=4), 3.9, 10.0)
CONCENTRATION, LEVEL = "choudhury05-concentration", "farenzena12"


class Row(NamedTuple):
    """A loop; `at`: a plant under another controller than that of `plant`; `more` of its `Course`."""

    plant: str
    label: str
    cause: str
    noise: float
    rows: int = 2000
    at: Plant | None = None
    more: Mapping[str, Any] = MappingProxyType({})


def _tuned(plant: str, gain: float, reset: float) -> Plant:
    return PLANTS[plant].tuned(gain, reset)


WELL_TUNED = (
    Row("choudhury04", "noise", NOISE, 0.22, 2048),
    Row("choudhury04", "load", NOISE, 0.05, 2048, more={"load": of.coloured(0.8, 0.9)}),
    Row("kano04-flow", "load", NOISE, 0.2, more={"load": of.coloured(0.5, 0.95)}),
    Row("kano04-level", "load", NOISE, 0.05, more={"load": of.coloured(0.5, 0.95)}),
    Row("karra09", "walk", NOISE, 0.05, 2500, more={"load": of.walk(0.1)}),
    Row("bacci14", "coloured-noise", NOISE, 0.3, 2500, more={"colour": 0.9}),
    Row(LEVEL, "load", NOISE, 0.05, 2500, more={"load": of.coloured(1.0, 0.98)}),
    Row("drifting-lag", "walk", NOISE, 0.05, 2500, more={"load": of.together(of.walk(0.05), of.coloured(1.0, 0.99))}),
)
TIGHT = (
    Row("choudhury04", "tight", TUNING, 0.22, 2048, _tuned("choudhury04", 0.15, 0.15 / 0.25)),
    Row("choudhury04", "tighter", TUNING, 0.05, 2048, _tuned("choudhury04", 0.15, 0.15 / 0.27)),
    Row(CONCENTRATION, "tight", TUNING, 0.1, 2000, _tuned(CONCENTRATION, 0.42, 10.0)),
    Row("rossi05-lag", "tight", TUNING, 0.03, 2500, _tuned("rossi05-lag", 12.0, 3.5)),
    Row("rossi05-equal", "tight", TUNING, 0.1, 2500, _tuned("rossi05-equal", 1.5, 12.0)),
    Row("bacci14", "tight", TUNING, 0.05, 2500, _tuned("bacci14", 2.6, 10.0)),
    Row(LEVEL, "ringing", TUNING, 0.05, 2500, _tuned(LEVEL, 1.0, 8.0), {"load": of.white(0.3)}),
    Row("singhal05", "tight", TUNING, 0.05, 2000, _tuned("singhal05", 4.6, 80.0)),
    Row("nordin02-servo", "ringing", TUNING, 0.02, 2000, _tuned("nordin02-servo", 2.0, 0.8), {"load": of.white(0.3)}),
    Row("choudhury04", "steps-tight", TUNING, 0.02, 2048, _tuned("choudhury04", 0.15, 0.15 / 0.25),
        {"load": of.on_and_off(4.0, 256)}),
)  # fmt: skip
SINES = (
    Row("choudhury04", "sine-on-pv", WAVES, 0.22, 2048, more={"on_pv": of.sine(2, 100)}),
    Row("choudhury04", "sine", WAVES, 0.05, 2048, more={"load": of.sine(2, 40)}),
    Row(CONCENTRATION, "sine", WAVES, 0.1, more={"load": of.sine(3, 120)}),
    Row("choudhury05-level", "sine", WAVES, 0.05, more={"load": of.sine(1, 50)}),
    Row("kano04-flow", "sine", WAVES, 0.1, more={"load": of.sine(2, 5)}),
    Row("kano04-level", "sine", WAVES, 0.02, more={"load": of.sine(2, 60)}),
    Row("horch99-flow", "sine", WAVES, 0.05, more={"load": of.sine(3, 20)}),
    Row("rossi05-equal", "sine", WAVES, 0.1, 2500, more={"load": of.sine(3, 60)}),
    Row("rossi05-delay", "sine", WAVES, 0.1, 2500, more={"load": of.sine(3, 90)}),
    Row("karra09", "sine-walk", WAVES, 0.05, 2500, more={"load": of.together(of.walk(0.1), of.sine(1.5, 60))}),
    Row("fang15", "sine-steps", WAVES, 0.05, 2500, more={"load": of.sine(2, 70), "set_point": of.steps(4)}),
    Row("fang15", "two-sines", WAVES, 0.05, 2500, more={"load": of.together(of.sine(2, 70), of.sine(1, 31))}),
    Row("romano11-bent", "sine", WAVES, 0.05, 2500, more={"load": of.sine(4, 60)}),
)
SET_POINTS = (
    Row("hagglund07-lag", "steps", SET_POINT, 0.05, more={"set_point": of.steps(5)}),
    Row("hagglund07-lag", "steps-noise", SET_POINT, 0.3, more={"set_point": of.steps(5)}),
    Row("hagglund07-level", "steps", SET_POINT, 0.02, 3000, more={"set_point": of.steps(3)}),
    Row("horch99-flow-slave", "sp45", SET_POINT, 0.05, more={"set_point": COURSES["sp45"].set_point}),
    Row("horch99-flow-slave", "sp45", SET_POINT, 0.05, more={"set_point": COURSES["sp45"].set_point}),
    *(Row("he07-lag", one, SET_POINT, 0.05, more={"set_point": COURSES[one].set_point})
      for one in ("sp150", "sp150and37", "spwalk", "sptriangle")),
)  # fmt: skip
ENDS = (
    Row("singhal05", "rounded-pv", SENSOR, 0.02, more={"load": of.coloured(2.0, 0.97), "sensor": of.rounded(0.1)}),
    Row("stenman03", "clipped-pv", SENSOR, 0.05, more={"load": of.sine(6, 100), "sensor": of.clipped(0, 50.8)}),
    Row("delayed", "clipped-pv-tight", SENSOR, 0.05, at=DELAYED, more={"sensor": of.clipped(49, 51)}),
    Row("delayed", "op-at-its-ends", SENSOR, 0.05, at=DELAYED.tuned(6.0, 10.0)),
)
NEAR = (  # plant, share of the gain at which it rings for ever, noise
    ("choudhury04", 0.97, 0.2), (CONCENTRATION, 0.97, 0.2), ("rossi05-equal", 0.98, 0.1), ("rossi05-delay", 0.96, 0.1),
    ("bacci14", 0.95, 0.05), ("singhal05", 0.95, 0.05), ("he07-lag", 0.99, 0.03),
)  # fmt: skip
NEAR_WITH_STEPS = (
    ("choudhury04", 0.95, 0.2), ("rossi05-equal", 0.95, 0.1), ("rossi05-delay", 0.93, 0.1), ("bacci14", 0.92, 0.05),
    ("he07-lag", 0.95, 0.03), ("he07-level", 0.95, 0.02),
)  # fmt: skip
LIMITS = (
    *(Row(plant, f"near-{share:g}", TUNING, noise, at=PLANTS[plant].near_its_limit(share))
      for plant, share, noise in (*NEAR, *NEAR_WITH_STEPS)),
    *(Row(plant, "near-0.85-steps", TUNING, noise, at=PLANTS[plant].near_its_limit(0.85),
          more={"set_point": of.steps(4)}) for plant, _, noise in NEAR_WITH_STEPS),
)  # fmt: skip
SQUARES = (
    Row("horch99-flow", "square-40", EDGES, 0.05, more={"load": of.square(2, 40)}),
    Row("horch99-flow", "square-22", EDGES, 0.15, more={"load": of.square(2, 22)}),
    *(Row("garcia08-lag", f"square-{period}", EDGES, 0.05, more={"load": of.square(2, period)})
      for period in (20, 40, 80, 160)),
    *(Row(LEVEL, f"square-{period}", EDGES, 0.02, rows, more={"load": of.square(2, period)})
      for period, rows in ((90, 2500), (60, 2000), (90, 2000), (150, 2000))),
    Row(CONCENTRATION, "square-120", EDGES, 0.05, more={"load": of.square(2, 120)}),
    Row("he07-lag", "square-70", EDGES, 0.05, more={"load": of.square(2, 70)}),
    Row("choudhury04", "square-60", EDGES, 0.05, more={"load": of.square(2, 60)}),
    *(Row(plant, f"telegraph-{chance:g}", EDGES, noise, more={"load": of.telegraph(2, chance)})
      for plant, chance, noise in (
          ("garcia08-lag", 0.03, 0.05), ("garcia08-lag", 0.03, 0.05), ("garcia08-lag", 0.01, 0.05),
          ("he07-lag", 0.02, 0.05), (LEVEL, 0.02, 0.02), ("choudhury04", 0.02, 0.05))),
    Row("garcia08-lag", "pulses", EDGES, 0.05, more={"load": of.pulses(4, 120, 25)}),
)  # fmt: skip
TRIANGLES = (
    Row("stenman03", "triangle-70", EDGES, 0.05, more={"load": of.triangle(3, 70)}),
    Row("kano04-level", "triangle-120", EDGES, 0.02, more={"load": of.triangle(3, 120)}),
    Row("garcia08-lag", "saw-100", EDGES, 0.05, more={"load": of.saw(3, 100)}),
    *(Row(plant, f"triangle-{period}", EDGES, noise, more={"load": of.triangle(3, period)})
      for plant, period, noise in (
          (CONCENTRATION, 100, 0.05), (CONCENTRATION, 150, 0.05), (CONCENTRATION, 150, 0.4), (CONCENTRATION, 200, 0.05),
          ("he07-lag", 60, 0.05), ("he07-lag", 120, 0.05), (LEVEL, 80, 0.02))),
)  # fmt: skip
CONSTANT_STAIRS = stem_of("garcia08-lag", He(3, 1))
FROM_UPSTREAM = (
    Row("hagglund07-lag", "pv-of-kano-5-2", UPSTREAM, 0.05, more={"load": pv_of(CONCENTRATION, Kano(5, 2), 0.5)}),
    Row("garcia08-lag", "pv-of-kano-3-1", UPSTREAM, 0.05, more={"load": pv_of("choudhury04", Kano(3, 1), 1.0)}),
    Row("garcia08-lag", "stairs-of-he-3-1", UPSTREAM, 0.05, more={"load": CONSTANT_STAIRS}),
    Row(LEVEL, "stairs-of-he-3-1", UPSTREAM, 0.02, 2500, more={"load": CONSTANT_STAIRS}),
    *(Row(plant, f"stairs-of-{valve.label}-tight", UPSTREAM, noise,
          more={"load": stem_of("garcia08-lag-tight", valve)})
      for plant, valve, noise in (
          ("garcia08-lag", He(3, 1), 0.05), ("garcia08-lag", Stenman(2), 0.05), ("he07-lag", Stenman(2), 0.05),
          (LEVEL, Stenman(2), 0.02), (LEVEL, He(3, 1), 0.02), ("choudhury04", He(3, 1), 0.05))),
)  # fmt: skip
TABLES = (WELL_TUNED, TIGHT, SINES, SET_POINTS, ENDS, LIMITS, SQUARES, TRIANGLES, FROM_UPSTREAM)


def sound_cases() -> Iterator[Case]:
    """All of the tables; one that is there already comes with another seed."""
    seen: dict[str, int] = {}
    for row in (row for table in TABLES for row in table):
        name = f"{row.plant}:sound:{row.label}"
        seen[name] = seen.get(name, 0) + 1
        number = f":{seen[name]}" if seen[name] > 1 else ""
        course = Course(row.cause, noise=row.noise, **row.more)
        yield Case(name + number, row.at or PLANTS[row.plant], Sound(), row.rows, course)
