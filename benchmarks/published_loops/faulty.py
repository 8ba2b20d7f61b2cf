"""Loops whose valve has a fault: which valve in which plant, for so many rows, under which courses of events."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from published_loops import signals
from published_loops.case import MUCH_NOISE, Case, Course
from published_loops.plants import PLANTS
from published_loops.valves import (
    Behind,
    Chen,
    Choudhury,
    DeadZone,
    He,
    Kano,
    Karnopp,
    LuGre,
    Play,
    Stenman,
    Valve,
)

WALKS = "and a walk"

COURSES = {
    "rest": Course("at rest"),
    "rest1": Course("at rest, noise of 1 %", share=0.01),
    "rest2": Course("at rest, noise of 2 %", share=0.02),
    "rest5": Course("at rest, noise of 5 %", share=MUCH_NOISE),
    "steps": Course("set point in steps", signals.steps_by_size),
    "steps5": Course("set point in steps, noise of 5 %", signals.steps_by_size, share=MUCH_NOISE),
    "large": Course("set point in large steps", signals.large_steps, share=0.01),
    "steps4": Course("set point in steps of up to 4 %", signals.steps(4.0), noise=0.02),
    "load": Course("slow load", load=signals.slow_load),
    "load5": Course("slow load, noise of 5 %", load=signals.slow_load, share=MUCH_NOISE),
    "sp45": Course("set point of a master", signals.sine(3, 45), noise=0.05),
    "sp150": Course("set point of a master", signals.sine(3, 150), noise=0.05),
    "sp150and37": Course(
        "set point of a master", signals.together(signals.sine(3, 150), signals.sine(2, 37)), noise=0.05
    ),
    "spwalk": Course("set point of a master", signals.smooth_walk, noise=0.05),
    "sptriangle": Course("set point of a master", signals.triangle(4, 200), noise=0.05),
}


class Row(NamedTuple):
    """Loops of one plant and valve; `walk`: what the load walks in a row beside its course, %."""

    plant: str
    valve: Valve
    rows: int
    courses: str
    walk: float = 0.0


TIGHT = "he07-lag-tight", "choudhury04", "he07-level", "choudhury05-concentration", "garcia08-lag-tight"
FRICTION = (2.5, 1.5), (2, 1), (3, 2), (3, 1), (2, 1)  # static and sliding, of the plants of TIGHT
LAGS = 0.3, 1, 3  # s

PUBLISHED = (
    Row("choudhury05-concentration", Kano(5, 0), 2000, "steps load"),
    Row("choudhury05-concentration", Kano(5, 2), 2000, "rest rest5 steps load"),
    Row("choudhury05-concentration", Kano(5, 5), 2500, "rest rest5 steps load"),
    Row("choudhury05-concentration", Kano(5, 7), 2000, "rest rest5"),
    Row("choudhury05-concentration", Choudhury(3, 1), 2000, "rest"),
    Row("choudhury05-level", Kano(3, 0), 2000, "rest rest5 steps load"),
    Row("choudhury05-level", Kano(3, 1.5), 2000, "rest rest5 steps"),
    Row("choudhury05-level", Kano(3, 3), 1500, "rest rest5"),
    Row("choudhury05-level", Kano(3, 4.5), 1500, "rest rest5"),
    Row("choudhury04", Kano(3, 1), 2048, "rest rest5 steps load"),
    Row("choudhury04", Kano(6, 3), 2048, "rest rest5"),
    Row("choudhury04", Choudhury(3, 1), 2048, "rest"),
    Row("choudhury04", Kano(2, 2), 2048, "rest rest5"),
    Row("kano04-flow", Kano(5, 3), 2000, "rest rest5 steps load"),
    Row("kano04-flow-1s", Kano(3, 3), 1500, "rest rest5"),
    Row("kano04-level", Kano(3, 1), 2000, "rest rest5 steps"),
    Row("kano04-level", Kano(5, 5), 2000, "rest rest5 load"),
    Row("stenman03", Stenman(2), 1500, "rest rest5 steps load"),
    Row("horch99-flow", Stenman(3), 2000, "rest rest5"),
    Row("horch99-level", Stenman(3), 2000, "rest rest5"),
    Row("hagglund95", Stenman(1.5), 2000, "rest rest5"),
    Row("hagglund07-lag", Play(5), 2000, "steps load"),
    Row("hagglund07-lags", Play(2), 3000, "steps load"),
    Row("hagglund07-level", Play(4), 3000, "rest rest5 steps load"),
    Row("he07-lag", He(5, 2), 2000, "rest rest5 steps load"),
    Row("he07-lag", He(3, 1), 2000, "rest"),
    Row("he07-level", He(3, 2), 2500, "rest rest5 steps"),
    Row("he07-lag", Chen(4, 2), 2000, "rest rest5"),
    Row("jelali08-flow", Kano(5, 2), 2000, "rest rest5 load"),
    Row("jelali08-flow", Kano(3, 4), 1500, "rest rest5"),
    Row("jelali08-level", Kano(4, 2), 2000, "rest rest5 steps"),
    Row("rossi05-lag", Kano(5, 2), 2500, "rest rest5"),
    Row("rossi05-equal", Kano(6, 3), 2500, "rest rest5 steps"),
    Row("rossi05-delay", Kano(6, 3), 2500, "rest rest5"),
    Row("garcia08-lag", Karnopp(3, 2), 2000, "rest rest5 steps load"),
    Row("garcia08-lag", Karnopp(4, 3.5), 2000, "rest steps"),
    Row("garcia08-level", Karnopp(2, 1), 2000, "rest rest5"),
    Row("garcia08-lag", LuGre(3, 2), 1500, "rest steps"),
    Row("garcia08-level", Karnopp(2, 2), 2000, "rest steps"),
    Row("srinivasan05", Stenman(1.5), 2000, "rest rest5"),
    Row("karra09", Kano(4, 2), 2500, "rest rest5 load", 0.03),
    Row("karra09", Kano(4, 0), 2500, "steps load", 0.03),
    Row("romano11", Kano(5, 2), 2500, "rest rest5 steps"),
    Row("lee08", He(3, 1.5), 2500, "rest rest5"),
    Row("lee08", Kano(2, 0.5), 2500, "rest rest5 steps"),
    Row("fang15", Play(3), 3000, "steps load"),
    Row("fang15", Kano(8, 1), 2500, "rest rest5"),
    Row("bacci14", He(4, 2), 2500, "rest rest5 load"),
    Row("bacci14", Kano(6, 1), 2500, "rest steps"),
    Row("zabiri09", Kano(6, 6), 2000, "rest rest5"),
    Row("zabiri09-tight", Kano(4, 1), 2000, "rest steps"),
    Row("selvanathan10-level", Play(3), 2000, "rest rest5 steps"),
    Row("selvanathan10-lag", Play(4), 2500, "rest rest5 steps load"),
    Row("nordin02-servo", Play(2), 2000, "rest rest5 steps"),
    Row("singhal05", Kano(4, 2), 2000, "rest rest5"),
    Row("farenzena12", Kano(4, 4), 2500, "rest rest5 load"),
    Row("farenzena12", Kano(4, 0.5), 2500, "rest rest5"),
    Row("thornhill07-flow", Kano(2, 1.5), 2000, "rest rest5 load"),
    Row("zone-level", DeadZone(6), 2500, "rest rest5 steps load"),
    Row("zone-lag", DeadZone(5), 2500, "steps load"),
    Row("zone-lag-tight", DeadZone(8), 2500, "steps load"),
)
FRICTION_MODELS = (  # in one loop, and one model in other loops
    Row("garcia08-lag", He(3, 2), 2000, "rest steps load"),
    Row("garcia08-lag", Kano(5, 1), 2000, "rest steps load"),
    Row("garcia08-lag", Karnopp(3, 2), 2000, "rest steps load steps5"),
    Row("garcia08-lag", Karnopp(2, 1), 2000, "rest steps load steps5"),
    Row("garcia08-lag", Karnopp(2.5, 2), 2000, "rest steps load"),
    Row("garcia08-lag", Karnopp(1.5, 0.7), 2000, "rest steps load"),
    Row("choudhury05-concentration", Karnopp(3, 1), 2500, "rest steps load"),
    Row("choudhury04", Karnopp(2, 1), 2000, "rest steps load"),
    Row("he07-lag-tight", Karnopp(2.5, 1.5), 2000, "rest steps load steps5"),
    Row("he07-level", Karnopp(3, 2), 2500, "rest steps load steps5"),
    Row("garcia08-slow", Karnopp(2, 1.2), 2000, "rest steps load"),
    Row("choudhury04", LuGre(2, 1), 1500, "rest steps"),
)
NOISE_AND_STEPS = (
    Row("choudhury04", Kano(3, 1), 2048, "steps5 load5"),
    Row("choudhury05-concentration", Kano(5, 0), 2000, "steps5 load5"),
    Row("hagglund07-lag", Play(2), 2000, "steps5 load5"),
    Row("fang15", Play(3), 3000, "steps5 load5"),
    Row("he07-level", He(3, 2), 2500, "steps5 load5"),
    Row("kano04-flow", Kano(5, 3), 2000, "steps5 load5"),
    Row("kano04-level", Kano(3, 1), 2000, "steps5 load5"),
    Row("selvanathan10-level", Play(3), 2000, "steps5 load5"),
    Row("romano11", Kano(5, 2), 2500, "load steps5 load5"),
    Row("karra09", Kano(2, 1), 2500, "load steps5 load5", 0.08),
    Row("kano04-flow", Kano(5, 3), 2000, "steps"),
    Row("kano04-flow", Kano(3, 1), 2000, "steps"),
    Row("kano04-flow-1s", Kano(3, 3), 1500, "steps"),
    Row("jelali08-flow", Kano(5, 2), 2000, "steps steps5"),
)
OVERSHOOT_AND_SMALL = (
    Row("choudhury05-concentration", Kano(5, 7), 2000, "rest5"),
    Row("choudhury05-concentration", Kano(3, 5), 2000, "rest rest5 load"),
    Row("choudhury04", Kano(2, 3), 2048, "rest rest5"),
    Row("choudhury04", Kano(2, 2), 2048, "rest load"),
    Row("choudhury04", Kano(1.2, 0.4), 2048, "rest rest5 load"),
    Row("hagglund07-lag", Play(1.2), 2000, "steps load"),
    Row("zone-level", DeadZone(6), 2500, "rest load", 0.15),
    Row("kano04-level", DeadZone(5), 2000, "steps load steps5"),
    Row("choudhury05-concentration", DeadZone(5), 2500, "steps steps5 load5", 0.1),
    *(Row("choudhury05-concentration", Kano(*valve), 2000, "rest5 rest5") for valve in ((5, 7), (3, 4), (2, 3))),
    Row("rossi05-equal", Kano(3, 4.5), 2000, "rest5 rest5"),
    Row("choudhury05-level", Kano(3, 4.5), 2000, "rest5 rest5"),
)
LAGGING_PRESSURE = (
    *(Row(plant, Karnopp(*friction, lag), 2000, "rest rest2")
      for plant, friction in zip(TIGHT, FRICTION, strict=True) for lag in (0.05, 1)),
    *(Row(plant, Karnopp(*friction), 2000, "rest rest1 rest2 rest5 large")
      for plant, friction in zip(TIGHT, FRICTION, strict=True)),
    *(Row(plant, He(*friction), 2000, "rest1") for plant, friction in zip(TIGHT, FRICTION, strict=True)),
    *(Row(plant, Behind(0.3, He(*friction)), 2000, "rest1") for plant, friction in zip(TIGHT, FRICTION, strict=True)),
    *(Row(plant, Karnopp(*friction, damping=20_000.0), 2000, "rest1")
      for plant, friction in zip(TIGHT, FRICTION, strict=True) if plant not in ("he07-level", TIGHT[3])),
    *(Row(f"{plant}-5s", Karnopp(*friction), 2000, "rest1")
      for plant, friction in zip(TIGHT, FRICTION, strict=True) if f"{plant}-5s" in PLANTS),
)  # fmt: skip
SLOW_LOAD = (
    *(Row("garcia08-lag", valve, 2000, "load load") for valve in (He(3, 2), He(2, 1), He(4, 2))),
    Row("he07-lag", He(3, 2), 2000, "load load"),
    Row("choudhury04", He(3, 2), 2000, "load load"),
    Row("garcia08-lag", Stenman(2), 2000, "load load"),
    Row("garcia08-lag", Kano(5, 2), 2000, "load load"),
)
LAGGING_ACTUATOR = (
    *(Row("he07-lag-tight", Behind(lag, Kano(4, 1)), 2000, "rest1") for lag in LAGS),
    *(Row("choudhury04", Behind(lag, Kano(3, 1)), 2000, "rest1 steps4") for lag in LAGS),
    *(Row("garcia08-lag-tight", Behind(lag, Kano(3, 1)), 2000, "rest1 steps4") for lag in LAGS),
    *(Row("he07-level", Behind(lag, Kano(5, 1)), 2000, "rest1") for lag in LAGS),
    *(Row("choudhury05-concentration", Behind(lag, Kano(4, 2)), 2000, "rest1 steps4") for lag in LAGS),
    *(Row("selvanathan10-level", Behind(lag, Play(3)), 2000, "rest1") for lag in LAGS),
)
CASCADES = (
    Row("horch99-flow-slave", Kano(3, 1), 2000, "sp45"),
    *(Row("he07-lag", Kano(3, 1), 2000, course) for course in ("sp150", "sp150and37", "spwalk", "sptriangle")),
)
TABLES = (
    PUBLISHED,
    FRICTION_MODELS,
    NOISE_AND_STEPS,
    OVERSHOOT_AND_SMALL,
    LAGGING_PRESSURE,
    SLOW_LOAD,
    LAGGING_ACTUATOR,
    CASCADES,
)


def faulty_cases() -> Iterator[Case]:
    """All of the tables; one that is there already comes with another seed."""
    seen: Counter[str] = Counter()
    for row in (row for table in TABLES for row in table):
        for course in row.courses.split():
            name = f"{row.plant}:{row.valve.label}:{course}" + ("-walk" if row.walk else "")
            seen[name] += 1
            number = f":{seen[name]}" if seen[name] > 1 else ""
            yield Case(name + number, PLANTS[row.plant], row.valve, row.rows, _course(course, row.walk))


def _course(name: str, walked: float) -> Course:
    course = COURSES[name]
    if walked == 0:
        return course
    walk = signals.walk(walked)
    load = walk if course.load is None else signals.together(walk, course.load)
    return replace(course, words=f"{course.words} {WALKS}", load=load)
