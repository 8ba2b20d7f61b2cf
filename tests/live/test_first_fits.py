"""First fits in a process beside give the same bits, also where that process is killed."""

import os
import signal

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import EngineError
from lostmotion.files.grid import Rows
from lostmotion.live.first_fits import FirstFits
from lostmotion.live.warm import warm
from lostmotion.online import OnlineMonitor
from lostmotion.online.service import at_once

pytestmark = pytest.mark.long

SAMPLES = 1500


def monitor():
    return OnlineMonitor(lm.RecursiveML(3, 2, 3, start_samples=700, dt=0.1), dt=0.1, report_every=700)


@pytest.fixture(scope="module")
def pieces():
    loop = lm.routine_operation(SAMPLES, drift="none", seed=1)
    y = loop.measured.copy()
    y[300] = np.nan
    rows = Rows(0.1 * np.arange(SAMPLES), loop.command, y)
    return [rows.part(0, 690), rows.part(690, 710), rows.part(710, SAMPLES)]


@pytest.fixture(scope="module")
def here(pieces):
    watched, said = monitor(), []
    for rows in pieces:
        watched, found = at_once(watched, rows)
        said += found
    assert watched.estimator.started
    return watched.to_bytes(), said


def test_the_same_bits_beside_and_after_a_kill(pieces, here):
    warm()
    watched, said = monitor(), []
    with FirstFits() as fits:
        for rows in pieces:
            watched, found = fits.take(watched, rows)
            said += found
            (worker,) = fits._engine._pool.workers
            os.kill(worker.process.pid, signal.SIGKILL)
    assert (watched.to_bytes(), said) == here


def test_here_where_no_worker_can_be_had(pieces, here, monkeypatch):
    fits = FirstFits()

    def unable(*_):
        raise EngineError("no worker")

    monkeypatch.setattr(fits._engine, "run", unable)
    watched, said = monitor(), []
    with fits:
        for rows in pieces:
            watched, found = fits.take(watched, rows)
            said += found
    assert (watched.to_bytes(), said) == here
