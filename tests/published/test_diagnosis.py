"""Real loops with the labels of their contributors; the whole tables are made by benchmarks/diagnosis.py."""

import csv

import pytest

import lostmotion as lm
from tests.support.shared_data import shared

pytestmark = pytest.mark.statistics
STICKING = ("stiction", "backlash")
TYPES = ("flow", "pressure", "temperature", "level")
SCAN = {"CHEM10": 30.0, "CHEM11": 30.0, "CHEM12": 30.0}  # their time column says so
FEWEST_RIGHT = 18


def verdicts():
    """Label and diagnosis of the 26 loops of ISDB (Jelali and Huang, Springer 2010), one fixed configuration."""
    found = {}
    with shared("isdb26/labels.csv").open(newline="", encoding="utf-8") as stream:
        for row in csv.DictReader(stream):
            record = lm.read_loop(shared(f"isdb26/{row['file']}"), dt=SCAN.get(row["loop"], float(row["dt_s"])))
            kind = row["type"] if row["type"] in TYPES else "other"
            diagnosis = lm.diagnose(record, loop_type=kind, integrating=row["integrating"] == "True")
            found[row["loop"]] = (row["label"], diagnosis)
    return found


@pytest.mark.long
def test_the_26_loops():
    """One test: a minute of diagnoses, which workers would make one by one each."""
    found = verdicts()
    right = {loop: (said.verdict in STICKING) == (label == "stiction") for loop, (label, said) in found.items()}
    assert len(right) == 26
    assert sum(right.values()) >= FEWEST_RIGHT, [loop for loop, good in right.items() if not good]
    assert found["PAP4"][1].verdict == "dead zone"
    for _, said in found.values():
        assert said.advice
        assert 0.5 <= said.confidence <= 1.0
        assert said.summary()


def test_healthy_positioner_has_nothing():
    record = lm.read_loop(
        shared("damadics/lublin_actuator3_2001-10-11_1h.csv"), op="LC74_20CV_pct", pv="LC74_20X_pct", sp=None
    )
    found = lm.diagnose(record)
    assert found.verdict == "cannot tell"  # the record excludes no dead band of 1 % of span, but one of 4 %
    assert found.excluded["dead zone"] < 4.0
    assert lm.diagnose(record, tolerance=0.04).verdict == "none"
