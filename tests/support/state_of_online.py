"""A state file as the command writes it, and one start with another one: run as a script, in a process of its own."""

import json
import sys
from pathlib import Path
from threading import Event

import numpy as np

import lostmotion as lm
from lostmotion.errors import LostMotionError
from lostmotion.files.follow import Follower
from lostmotion.files.layout import Asked
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import Kept, Service

MODEL = {"na": 1, "nb": 0, "delay": 1, "gain": None, "noise": "white", "forgetting": 0.9995, "start_samples": 300}
WATCH = {"report_every": 100, "trend_every": 200, "op_limits": (-50.0, 50.0), "frozen": 40}


def rows(n):
    """Text of a record."""
    random = np.random.default_rng(1)
    u = lm.signals.prs(n, -5, 5, hold=8, seed=1)
    x = np.where(u > 1, u - 1, np.where(u < -1, u + 1, 0.0))
    y = lm.LinearModel((-0.8,), (0.2,), 1).simulate(x) + 0.05 * random.normal(size=n)
    lines = [f"{2 * k},{u[k]:.4f},{y[k]:.4f}\n" for k in range(n)]
    return "t_s,OP,PV\n" + "".join(lines)


def start(record, state):
    """Lines said by one start that reads to the end of the record."""
    said = []

    def make(layout):
        return OnlineMonitor(lm.RecursiveML(**MODEL, dt=layout.dt), dt=layout.dt, calendar=layout.calendar, **WATCH)

    def emit(message):
        said.append(json.dumps(message, allow_nan=False))

    with Kept(state, {**MODEL, **WATCH}) as kept, Follower(record, Asked(), kept.position) as follower:
        Service(follower, kept, make, emit, 3.0).run(follow=False, stop=Event())
    return said


def main(folder):
    """Every state of the folder: "FILE outcome", each told before it is tried, so that one that kills is known."""
    for state in sorted(Path(folder).glob("*.state")):
        _tell(f"{state.name} ")
        _tell(f"{_outcome(Path(folder) / 'record.csv', state)}\n")
    _tell("done\n")


def _tell(text):
    sys.stdout.write(text)
    sys.stdout.flush()


def _outcome(record, state):
    try:
        start(record, state)
    except LostMotionError as error:
        return f"refused {type(error).__name__} {'MANY LINES' if chr(10) in str(error) else 'one line'}"
    except Exception as error:  # noqa: BLE001  it is what is sought
        return f"TRACEBACK {type(error).__name__} {str(error)[:100]!r}"
    return "works"


if __name__ == "__main__":
    main(sys.argv[1])
