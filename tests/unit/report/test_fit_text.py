"""The text of an identification: what is assumed, and how sure the kind is."""

from dataclasses import replace

from lostmotion.identify.actuators.choice import KindChoice
from tests.support.fits import made_fit


def text_of(fit):
    return " ".join(str(fit.summary()).split())


def test_an_integrating_process_is_not_said_to_be_in_deviations():
    fit = made_fit("backlash", integrating=True)
    fit = replace(fit, settings={**fit.settings, "offset_fixed": True})
    assert "no offset: the level of an integrating process is its initial state" in text_of(fit)
    assert "in deviations" not in text_of(fit)
    fixed = made_fit("backlash")
    assert "offset 0: the record is in deviations" in text_of(
        replace(fixed, settings={**fixed.settings, "offset_fixed": True})
    )


def test_no_kind_is_certain():
    gains = {"none": 0.0, "stiction": 90.0, "backlash": 20.0}
    choice = KindChoice("stiction", gains, gains, gains, 0.99999, "backlash", {})
    fit = replace(made_fit("stiction"), kinds=choice)
    assert "(confidence over 99 %)" in text_of(fit)
