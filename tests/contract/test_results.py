"""The repr of a result is one line; its text is summary()."""

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.audit import AuditRun
from lostmotion.evaluate import monte_carlo, random_faulty_loop, random_loop
from lostmotion.records import prepare
from lostmotion.simulate.adaptive_loop import AdaptiveHistory

LONGEST = 100


def white(u, y, dt):
    return lm.identify(u, y, dt, nonlinearity="dead zone", orders=(1, 0, 1), noise="white")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    loop = random_faulty_loop(4, cause="stiction", process="flow")
    record = lm.LoopRecord(loop.op, loop.pv, loop.sp, dt=1.0, tag="FIC-7")
    diagnosis = lm.diagnose(record)
    tank = lm.platforms.level_tank()
    plant = lm.Hammerstein(lm.Backlash(2.0), lm.LinearModel.from_continuous([1.0], [10.0, 1.0], 2.0, 0.5))
    u = lm.signals.prs(1000, -5, 5, 10, seed=0)
    recursive = lm.RecursiveIV(na=3, nb=2, delay=3)
    trajectory = recursive.run(u, tank.simulate(u))
    design = lm.design(tank, 0.03, op_limits=(-5, 5), duration=100, effort=0.1)
    study = lm.compensation_study(
        plant, lm.PI(2.0, 0.5), noise=1e-4, op_now=50.0, samples=300, runs=1, cycle_samples=600
    )
    store = tmp_path_factory.mktemp("audit") / "plant.db"
    found = [
        record, record.check(), lm.check(record), prepare(record), prepare(lm.LoopRecord([1.0] * 99, [1.0] * 99, dt=1)),
        diagnosis, diagnosis.fit, diagnosis.fit.facts, lm.diagnose([record[:1000], record[1000:]]),
        lm.identify(record, nonlinearity="none"), lm.solve(record[:150]), study, study.block, study.block.run(u),
        lm.achievable(u, tank, 0.03), design, design.prediction,
        lm.simulate_loop(plant, lm.PI(2.0, 0.5), np.zeros(100), 0.5), recursive, trajectory, recursive.estimate,
        AdaptiveHistory(np.arange(3), np.zeros(3), np.ones(3), np.ones(3, bool)), loop, random_loop(1, samples=200),
        lm.RecursiveML(3, 2, 3), lm.PI(1.0, 0.1), tank, monte_carlo(estimator=white, cases=1, samples=200, workers=1),
        lm.audit({"FIC-7": record}, store=store, engine="inline", screen_only=True),
    ]  # fmt: skip
    return {type(one): one for one in found}


def test_one_line_each(results):
    for kind, result in results.items():
        shown = repr(result)
        assert "\n" not in shown, kind
        assert len(shown) <= LONGEST or kind is lm.Hammerstein, shown
        assert "array(" not in shown, shown


def test_every_public_result_is_looked_at(results):
    public = {getattr(lm, name) for name in lm.__all__}
    written = {kind for kind in public if isinstance(kind, type) and {"summary", "plot"} & set(dir(kind))}
    assert written - set(results) == set()


def test_what_it_says(results):
    assert repr(results[lm.HammersteinFit]).startswith("HammersteinFit(")
    facts, diagnosis = results[lm.FitFacts], results[lm.Diagnosis]
    low, high = facts.interval("band")
    assert repr(facts) == f"FitFacts(stiction {low:.4g}..{high:.4g}, OK, 2000 samples)"
    assert repr(diagnosis).startswith("Diagnosis(stiction ")
    assert f"severity {diagnosis.severity}" in repr(diagnosis)
    assert repr(results[lm.LoopResponse]) == "LoopResponse(100 samples every 0.5 s)"
    assert repr(results[AuditRun]).startswith("AuditRun(run 1 of ")
    assert "closed at" in repr(results[lm.Solution])
