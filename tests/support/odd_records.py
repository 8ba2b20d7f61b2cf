"""Records that no plant writes and every plant has once: constant, tiny, huge, exact, whole, with holes."""

import warnings
from pathlib import Path

import numpy as np

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.records import check

SIGNALS = {
    "constant": lambda n, random: np.full(n, random.choice([0.0, 1.0, -273.15, 1e-9])),
    "sine": lambda n, random: np.sin(np.arange(n) * random.choice([0.1, 0.31, 2 * np.pi / 20]) + random.uniform(0, 6)),
    "square": lambda n, random: np.sign(np.sin(np.arange(n) / 7 + random.uniform(0, 6))),
    "triangle": lambda n, random: np.abs(np.arange(n) % 40 - 20.0),
    "step": lambda n, random: (np.arange(n) > n * random.uniform(0.05, 0.95)).astype(float),
    "spike": lambda n, random: (np.arange(n) == n // 2).astype(float),
    "ramp": lambda n, random: np.arange(n, dtype=float),
    "whole": lambda n, random: random.integers(-3, 4, n).astype(float),
    "two values": lambda n, random: random.integers(0, 2, n).astype(float),
    "noise": lambda n, random: random.normal(size=n),
    "walk": lambda n, random: random.normal(size=n).cumsum(),
    "held": lambda n, random: np.repeat(random.normal(size=n // 8 + 1), 8)[:n],
    "rare": lambda n, random: np.where(random.random(n) < 0.01, 5.0, 0.0),
    "growing": lambda n, random: 1.5 ** np.minimum(np.arange(n), 150.0),
}
SIZES = (1e-300, 1e-150, 1e-20, 1e-6, 1.0, 1.0, 1.0, 1e6, 1e20, 1e29, 1e150)


def odd_record(number):
    """Record `number`, always the same: arrays and what they are called."""
    random = np.random.default_rng([19, number])
    n = int(random.choice([2, 10, 60, 61, 100, 300, 300]))
    names = [str(random.choice(list(SIGNALS))) for _ in range(2)]
    u = SIGNALS[names[0]](n, random)
    if random.random() < 0.4:  # a loop without noise
        pole, y = float(random.choice([0.0, 0.8, 1.0, 1.5, -1.0])), np.zeros(n)
        for k in range(1, n):
            y[k] = np.clip(pole * y[k - 1] + u[k - 1], -1e20, 1e20)
        names[1] = f"pole {pole}"
    else:
        y = SIGNALS[names[1]](n, random)
    u, y = (signal * float(random.choice(SIZES)) + float(random.choice([0.0, 0.0, 50.0, 1e6])) for signal in (u, y))
    if random.random() < 0.25:
        y[random.random(n) < random.choice([0.01, 0.3, 1.0])] = np.nan
    return u, y, f"{number} {names[0]}, {names[1]}, {n}"


def made_of(u, y):
    """What comes of a record by every door, with warnings as errors; the words of what went wrong."""
    wrong = []
    for work in (lambda r: str(check(r)), lambda r: lm.diagnose(r).summary(), lambda r: lm.identify(r).summary()):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                work(lm.LoopRecord(op=u, pv=y, dt=1.0))
        except LostMotionError as error:
            wrong += ["MANY LINES"] if "\n" in str(error) else []
        except Exception as error:  # noqa: BLE001  it is what is sought
            where = error.__traceback__
            places = []
            while where is not None:
                if "lostmotion" in where.tb_frame.f_code.co_filename:
                    places.append(f"{Path(where.tb_frame.f_code.co_filename).name}:{where.tb_lineno}")
                where = where.tb_next
            wrong.append(f"{type(error).__name__} {' '.join(places[-2:])} {str(error)[:60]}")
    return wrong
