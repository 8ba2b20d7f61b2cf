"""Results by their looks: the repr is one line, the text is summary(), and that is a table too."""

import json
import pickle
import re
import sys

import numpy as np
import pandas as pd
import polars as pl
import pytest

import lostmotion as lm
from lostmotion.audit import AuditRun
from lostmotion.diagnose.long_record.diagnose_long import diagnose_long
from lostmotion.evaluate import monte_carlo, random_faulty_loop, random_loop
from lostmotion.records import Prepared, prepare
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
        lm.actuator_response(lm.LoopRecord(u, lm.Backlash(2.0)(u), dt=1.0)),
        diagnosis, diagnosis.fit, diagnosis.fit.facts, lm.diagnose([record[:1000], record[1000:]]),
        diagnose_long(record), lm.identify(record, nonlinearity="none"), lm.solve(record[:150]),
        study, study.block, study.block.run(u),
        lm.achievable(u, tank, 0.03), design, design.prediction,
        lm.simulate_loop(plant, lm.PI(2.0, 0.5), np.zeros(100), 0.5), recursive, trajectory, recursive.estimate,
        AdaptiveHistory(np.arange(3), np.zeros(3), np.ones(3), np.ones(3, bool)), loop, random_loop(1, samples=200),
        lm.RecursiveML(3, 2, 3), lm.PI(1.0, 0.1), tank, monte_carlo(estimator=white, cases=1, samples=200, workers=1),
        lm.audit({"FIC-7": record}, store=store, engine="inline", screen_only=True),
    ]  # fmt: skip
    return {type(one): one for one in found}


@pytest.mark.long
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
    low, high = facts.size_interval
    assert repr(facts) == f"FitFacts(stiction {low:.4g}..{high:.4g}, OK, 2000 samples)"
    assert repr(diagnosis).startswith("Diagnosis(stiction ")
    assert f"severity {diagnosis.severity}" in repr(diagnosis)
    assert repr(results[lm.LoopResponse]) == "LoopResponse(100 samples every 0.5 s)"
    assert repr(results[AuditRun]).startswith("AuditRun(run 1 of ")
    assert "closed at" in repr(results[lm.Solution])


def test_summaries_are_tables(results):
    found = {kind: one for kind, one in results.items() if hasattr(one, "summary") and kind is not Prepared}
    assert len(found) >= 12
    for kind, result in found.items():
        summary = result.summary()
        assert str(summary) == repr(summary) == str(result)
        assert type(str(summary)) is str
        frame = summary.to_frame()
        assert isinstance(frame, pd.DataFrame), kind
        assert frame.shape[1] >= 4, kind
        assert summary.to_html() == summary._repr_html_()
        latex = summary.to_latex()
        assert latex.count(r"\begin{") == latex.count(r"\end{") > 0
        assert latex.startswith("\\begin{table}\n\\caption{")
        bare = re.sub(r"\\.", "", latex.replace(r"\\", ""))
        assert not set("%_#$^~<>|") & set(bare), bare


def test_what_a_summary_is_besides(results):
    summary = results[lm.HammersteinFit].summary()
    assert type(pickle.loads(pickle.dumps(summary))) is str  # noqa: S301  our own
    assert json.loads(json.dumps(summary)) == str(summary)


def test_numbers_of_a_fit(results, monkeypatch):
    facts = results[lm.FitFacts]
    frame = facts.summary().to_frame().set_index("parameter")
    assert frame.estimate.to_dict() == facts.parameters
    assert tuple(frame.loc["band", ["low", "high"]]) == facts.interval("band")
    assert "\nband & " in facts.summary().to_latex()
    monkeypatch.setitem(sys.modules, "pandas", None)
    without = facts.summary().to_frame()
    assert isinstance(without, pl.DataFrame)
    assert without.columns == ["parameter", *frame.columns]
