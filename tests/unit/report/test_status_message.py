"""OK of a linear model has a sentence of its own: no nonlinearity is shown by it."""

from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.identify.actuators.choice import KindChoice
from lostmotion.report.facts_text import facts_summary
from lostmotion.report.fit_text import fit_summary
from tests.support.fits import made_fit

GAINS = {"none": 0.0, "backlash": 1.0}
SHOWN = "shows the nonlinearity"


def compared(excluded):
    fit = made_fit("none")
    return replace(fit, kinds=KindChoice("none", GAINS, GAINS, GAINS, 0.99, "backlash", excluded))


def test_a_healthy_record_is_ok_without_a_nonlinearity():
    fit = compared({"backlash": 0.21, "stiction": 0.13})
    assert fit.message == "Converged; a linear model describes the record, and shows no lost motion."
    for text in (fit_summary(fit), facts_summary(fit.facts), fit.to_dict()["message"], fit._repr_html_()):
        assert SHOWN not in " ".join(text.split())
    words = " ".join(fit_summary(fit).split())
    assert words.count("A lost motion above 0.21 would have been seen (95 %") == 1
    assert lm.FitFacts.from_dict(fit.to_dict()).message == fit.message


def test_what_is_not_excluded_is_reported():
    fit = compared({"backlash": float("inf"), "stiction": 0.13})
    assert "does not bound the size of a lost motion" in " ".join(fit_summary(fit).split())
    unanswered = replace(fit, evidence=replace(fit.evidence, answered=False))
    assert unanswered.message.endswith("neither shows nor excludes one.")


def test_a_linear_model_as_requested_claims_nothing():
    fit = made_fit("none")
    assert fit.message == "Converged; a linear model describes the record; lost motion was not searched."
    assert "Linear model, as requested." in fit_summary(fit)


@pytest.mark.parametrize("kind", ["dead zone", "backlash", "stiction", "saturation"])
def test_the_others_keep_theirs(kind):
    assert made_fit(kind).message == lm.Status.OK.value
    assert made_fit("none", lm.Status.MISFIT).message == lm.Status.MISFIT.value
