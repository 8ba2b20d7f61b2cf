"""Real loops with the labels of their contributors; the whole tables are made by benchmarks/diagnosis.py."""

import csv
from functools import cache

import pytest

import lostmotion as lm
from tests.shared_data import shared

pytestmark = pytest.mark.statistics
STICKING = ("stiction", "backlash")
TYPES = ("flow", "pressure", "temperature", "level")
SCAN = {"CHEM10": 30.0, "CHEM11": 30.0, "CHEM12": 30.0}  # their time column says so
FEWEST_RIGHT = 18


@cache
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


def test_the_26_loops():
    right = {loop: (found.verdict in STICKING) == (label == "stiction") for loop, (label, found) in verdicts().items()}
    assert len(right) == 26
    assert sum(right.values()) >= FEWEST_RIGHT, [loop for loop, good in right.items() if not good]


def test_pap4_is_a_dead_zone():
    assert verdicts()["PAP4"][1].verdict == "dead zone"


def test_every_report_can_be_read():
    for _, found in verdicts().values():
        assert found.advice
        assert 0.5 <= found.confidence <= 1.0
        assert found.summary()


def test_healthy_positioner_has_nothing():
    record = lm.read_loop(
        shared("damadics/lublin_actuator3_2001-10-11_1h.csv"), op="LC74_20CV_pct", pv="LC74_20X_pct", sp=None
    )
    found = lm.diagnose(record)
    assert found.verdict == "cannot tell"  # the record excludes no dead band of 1 % of span, but one of 4 %
    assert found.excluded["dead zone"] < 4.0
    assert lm.diagnose(record, tolerance=0.04).verdict == "none"
