"""The page as people start it: the real command in a process of its own, with what it shows."""

from __future__ import annotations

import os
import secrets
import subprocess
import sys
import threading

import numpy as np

from lostmotion.files.results import write_json
from lostmotion.records import LoopRecord
from lostmotion.web.desk.item import ABOUT, Item
from lostmotion.web.kept_record import keep_record
from lostmotion.web.worker.task import RECORD
from tests.support.places import ROOT


class Served:
    """``lostmotion serve`` with some words; ended by :meth:`stop`."""

    def __init__(self, *words, patience=120.0):
        environment = {**os.environ, "PYTHONPATH": str(ROOT / "src")}
        command = [sys.executable, "-m", "lostmotion", "serve", "--no-open", *map(str, words)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment)
        timer = threading.Timer(patience, self.process.kill)
        timer.start()
        self.address = self.process.stdout.readline().strip()
        timer.cancel()
        assert self.address.startswith("http://127.0.0.1:"), f"no address within {patience} s"
        self.base, _, self.token = self.address.partition("/?token=")

    def stop(self):
        """End it as Ctrl-C does; exit code."""
        if self.process.poll() is None:
            self.process.terminate()
        try:
            return self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise
        finally:
            self.process.stdout.close()


def long_record(rows=1_000_000):
    """A loop with a swing, steps of SP, a stretch in manual, a hole, and one spike of a single row."""
    t = np.arange(rows)
    op = 50.0 + 5.0 * np.sin(t / 500.0) + np.sin(t / 7.0)
    pv = 20.0 + 2.0 * np.sin((t - 20) / 500.0)
    pv[int(0.654321 * rows)] = 40.0
    op[int(0.4 * rows) : int(0.41 * rows)] = np.nan
    mode = np.where((t > 0.2 * rows) & (t < 0.23 * rows), "MAN", "AUTO")
    sp = 20.0 + 0.5 * np.sign(np.sin(t / 40_000.0))
    return LoopRecord(
        op, pv, sp, dt=1.0, mode=mode, op_span=(0.0, 100.0), start="2026-03-02", tag="long", op_unit="%", pv_unit="t/h"
    )


def put_on_desk(folder, record, label):
    """A record that was read before, in the folder of ``--keep``; id of its item."""
    item = Item(secrets.token_hex(8), folder / "", label, (), came="2026-03-02T00:00:00+00:00")
    place = folder / item.id
    place.mkdir(parents=True)
    write_json(place / ABOUT, item.about())
    keep_record(place / RECORD, record)
    return item.id
