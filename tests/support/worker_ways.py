"""``python worker_ways.py WAY``: one way to start other processes, in whatever working folder this is run."""

import sys
import time
from pathlib import Path


def readers():
    from lostmotion.files.apart import leaves_apart

    assert leaves_apart("sheets", Path("p.xlsx").read_bytes())


def many_calls():
    from lostmotion.workers import Pool

    with Pool(2) as pool:
        assert list(pool.map(abs, [-1, 2, -3])) == [1, 2, 3]


def random_loops():
    from lostmotion.evaluate.workers import run_all

    assert run_all(abs, [-1, 2], "x", 2) == [1, 2]


def first_windows():
    import lostmotion as lm

    u = [lm.signals.prs(400, -5, 5, hold=10, seed=seed) for seed in range(2)]
    ones = [lm.RecursiveML(3, 2, 3, 1.0, start_samples=300) for _ in u]
    assert len(lm.run_many(ones, u, [2 * row for row in u], workers=2)) == 2


def page():
    from lostmotion.web.worker.handle import Worker

    worker, news = Worker(), []
    task = {"kind": "read", "folder": str(Path.cwd()), "sources": [str(Path("p.csv").absolute())], "label": "x"}
    assert worker.run(task, 100.0, news.append)["ended"]
    assert news
    worker.kill("")


def trend():
    from lostmotion.web.trend.loop_records import LoopRecords, Read

    loops = LoopRecords()
    while (found := loops.ask(Read("plant.db", 1, ".", "p"))) is None:
        time.sleep(0.05)
    assert "got no such file" in found, found


def study():
    import pytest

    from lostmotion.errors import LostMotionError
    from lostmotion.live.supervision.studies import Running, study_of_fit

    call = Running(study_of_fit, None, {})
    while not call.done:
        time.sleep(0.05)
    with pytest.raises(LostMotionError, match="the dictionary of a fit"):
        call.result()


def first_fits():
    from lostmotion.live.first_fits import FirstFits

    with FirstFits() as fits:
        assert fits._engine._pool.workers


if __name__ == "__main__":
    globals()[sys.argv[1]]()
