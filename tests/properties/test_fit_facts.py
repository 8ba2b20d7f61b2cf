"""A fit from its file is the fit: the same block to the last bit, the same refusal."""

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import lostmotion as lm
from lostmotion.errors import InputError, Status
from tests.support.fits import VALVES, made_fit
from tests.support.refusals import refusal

EXAMPLES = settings(max_examples=80)
levels = st.sampled_from([0.5, 0.8, 0.95, 0.99])


@st.composite
def fits(draw):
    """Any kind and status, sharp or vague, with noise of OP or without."""
    return made_fit(
        draw(st.sampled_from(sorted(VALVES))),
        draw(st.sampled_from(Status)),
        error=draw(st.sampled_from([1e-6, 0.03, 5.0])),
        op_noise=draw(st.sampled_from([0.0, 1e-3, 0.2])),
        closed_loop=draw(st.booleans()),
        integrating=draw(st.booleans()),
        widest=draw(st.sampled_from([None, 3.3, np.inf])),
        open_end=draw(st.booleans()),
        rivals=draw(st.sampled_from([(), ((48.1, 52.6, 2.0), (40.0, 60.0, 9.0))])),
        seed=draw(st.integers(0, 5)),
    )


options = st.fixed_dictionaries(
    {"span": st.sampled_from([(0.0, 100.0), (40.0, 50.0)])},
    optional={
        "level": levels,
        "scan_time": st.sampled_from([0.1, 0.5]),
        "factor": st.sampled_from([0.7, 1.0]),
        "op_noise": st.sampled_from([0.0, 0.3]),
        "ramp": st.just(0.2),
        "method": st.sampled_from(["knocker", "two moves"]),
    },
)


def block_or_refusal(fit, given_options):
    try:
        block = fit.block(**given_options)
    except InputError as error:
        return type(error), str(error)
    return block, block.notes


def read_back(fit):
    with TemporaryDirectory() as folder:
        return lm.read_fit(fit.save(Path(folder) / "fit.json"))


@EXAMPLES
@given(fits(), options)
def test_block_from_the_file_is_the_block_to_the_last_bit(fit, given_options):
    assert block_or_refusal(read_back(fit), given_options) == block_or_refusal(fit, given_options)


@EXAMPLES
@given(fits(), levels)
def test_facts_survive_their_file(fit, level):
    facts = read_back(fit)
    assert facts.to_dict() == fit.facts.to_dict() == read_back(facts).to_dict()
    whole, part = fit.to_dict(), facts.to_dict()
    assert whole.keys() > part.keys()
    assert all(whole[name] == part[name] for name in part.keys() - {"data", "settings"})
    assert all(whole["data"][name] == value for name, value in part["data"].items())
    assert facts.preferred == fit.preferred
    for name in fit.parameters:
        assert facts.interval(name, level) == fit.facts.interval(name, level) == fit.interval(name, level)
    np.testing.assert_array_equal(facts.covariance, fit.facts.covariance)
    assert facts.summary() == fit.facts.summary()


@EXAMPLES
@given(fits(), st.data())
def test_damaged_dictionary_is_refused_or_read_never_worse(fit, data):
    """Any value replaced or left out: an answer of the house, no other exception."""
    saved = json.loads(json.dumps(fit.to_dict()))
    group, path = saved, []
    while isinstance(group, dict) and group:
        key = data.draw(st.sampled_from(sorted(group)))
        path.append(key)
        if not isinstance(group[key], dict) or not group[key] or data.draw(st.booleans()):
            break
        group = group[key]
    wrong = data.draw(st.sampled_from([None, "x", -1, 1e999, True, [], [1], {}, [[1]], ["a", 2], "gone"]))
    if wrong == "gone":
        del group[path[-1]]
    else:
        group[path[-1]] = wrong
    try:
        facts = lm.FitFacts.from_dict(saved)
    except lm.DataError:
        refusal(lm.DataError, lm.FitFacts.from_dict, saved)
    else:
        assert facts.summary()


@pytest.mark.parametrize("kind", sorted(VALVES))
def test_made_fits_are_like_those_of_identify(kind):
    """What the other tests rest on."""
    facts = made_fit(kind).facts
    assert facts.preferred == kind
    assert set(type(facts.nonlinearity).own) <= facts.parameters.keys()
    assert 0.03 < facts.op_noise < 0.08
