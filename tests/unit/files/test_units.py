"""Engineering units in reports and figures where the record has them, and nowhere else."""

import re
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose import PooledDiagnosis
from lostmotion.diagnose.pooled.pooled_diagnosis import RecordShare
from lostmotion.diagnose.pooled.trend_of_size import SizeTrend
from tests.support.diagnoses import example, loop_record, variant
from tests.support.fits import VALVES, made_fit

RECORD = replace(loop_record(), op_unit="t/h", pv_unit="degC")


def with_units(fit):
    return replace(fit, data=replace(fit.data, op_unit="t/h", pv_unit="degC"))


def pooled(record):
    alone = {name: getattr(example(), name) for name in lm.Diagnosis.__dataclass_fields__}
    shares = tuple(RecordShare(f"day {k}", k, 400, "dead zone", 9.0, 4.0, (3.5, 4.5)) for k in range(3))
    return PooledDiagnosis(
        **{**alone, "record": record}, shares=shares, totals={"none": 0.0, "dead zone": 40.0}, kind_confidence=0.9,
        scatter=0.1, trend=SizeTrend(0.1, (0.05, 0.15), "record", 0.01, 3),
    )  # fmt: skip


@pytest.mark.statistics
def test_a_fit_takes_the_units_of_its_record():
    fit = lm.identify(RECORD, raw=True, orders=(1, 0, 1), noise="white", nonlinearity="dead zone")
    text = fit.summary()
    assert f"{fit.data.u.max():.5g} [t/h]\n" in text
    assert "[t/h], 95 % interval" in text.replace("\n  ", " ")
    lines = {line.split()[0]: line for line in text.splitlines() if line.split()}
    assert lines["left"].endswith("break point, OP falling [t/h]")
    assert lines["offset"].endswith("PV at rest inside the dead zone [degC]")
    assert lines["gain"].endswith("static gain of the linear part [degC per t/h]")
    assert lines["slope_ratio"].endswith("left_slope / right_slope")
    plain = replace(fit, data=replace(fit.data, op_unit="", pv_unit=""))
    removed = text.replace(" [t/h]", "").replace(" [degC]", "").replace(" [degC per t/h]", "")
    assert removed.split() == plain.summary().split()


@pytest.mark.parametrize("status", [lm.Status.OK, lm.Status.NOT_SEEN, lm.Status.ONE_SIDED])
@pytest.mark.parametrize("kind", list(VALVES))
def test_every_text_without_units_is_as_before(kind, status):
    """Units are added in brackets; nothing else changes."""
    fit = made_fit(kind, status, widest=2.0)
    found = " ".join(with_units(fit).summary().split())
    for unit in (" [t/h]", " [degC]", " [degC per t/h]"):
        found = found.replace(unit, "")
    assert found.split() == fit.summary().split()
    assert "[" not in fit.summary()


def test_diagnoses():
    text = replace(example(), record=RECORD).summary()
    assert "In units of OP [t/h]: full width" in text
    assert " [degC]" in text.split("PV about SP")[1].splitlines()[0]
    cleared = replace(variant("none", "none"), record=RECORD).summary()
    assert re.search(r"0\.6 of OP \[t/h\], [\d.]+ % of the OP range seen", cleared)  # of t/h no span is known
    assert "In units of OP: full width" in example().summary()


def test_pooled_diagnoses():
    text = " ".join(pooled(RECORD).summary().split())
    assert "In units of OP [t/h]: 4.16" in text
    assert "0.100 of OP [t/h] a record" in text
    assert "of OP [t/h]." in text
    assert "[" not in pooled(loop_record()).summary()


def test_figures():
    pytest.importorskip("matplotlib")
    axes = with_units(made_fit("dead zone")).plot().axes
    assert axes[0].get_xlabel() == "OP [t/h]"
    assert axes[0].get_ylabel() == "OP behind the valve (effective) [t/h]"
    assert axes[1].get_ylabel() == "PV [degC]"
    assert axes[1].get_title(loc="left").endswith("degC per t/h")
    assert (axes[2].get_ylabel(), axes[3].get_ylabel()) == ("PV [degC]", "OP [t/h]")
    assert pooled(RECORD).plot().axes[0].get_ylabel() == "size, units of OP [t/h]"
    assert made_fit("dead zone").plot().axes[0].get_ylabel() == "OP behind the valve (effective)"
    assert np.isfinite(pooled(RECORD).size)
