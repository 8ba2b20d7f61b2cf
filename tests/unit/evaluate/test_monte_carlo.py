import functools
import json
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.evaluate import MonteCarloResult, monte_carlo, random_loop
from lostmotion.evaluate.monte_carlo import measure
from lostmotion.evaluate.scores import GROUPS, CaseResult, score
from tests.support.refusals import refusal

SAMPLES = 400
COUNT = 8


@functools.cache
def loops():
    return [random_loop(index, seed=1, samples=SAMPLES) for index in range(COUNT)]


class Oracle:
    """Looks like a fit; off the truth by a number of expected standard errors."""

    def __init__(self, loop, off, status=lm.Status.OK):
        self.status, self.linear = status, loop.model.linear
        self.parameters = {name: loop.truth[name] + off * loop.expected[name] for name in loop.truth}
        self.standard_errors = loop.expected

    def interval(self, name, level=0.95):
        reach = 1.96 * self.standard_errors[name]
        return self.parameters[name] - reach, self.parameters[name] + reach


def loop_of(y):
    return next(loop for loop in loops() if np.array_equal(loop.y, y))


def run(estimator, **options):
    def knowing(u, y, dt):
        return estimator(loop_of(y))

    return monte_carlo(estimator=knowing, seed=1, cases=COUNT, samples=SAMPLES, workers=1, **options)


def test_the_truth_scores_full_marks():
    result = run(lambda loop: Oracle(loop, 0.0))
    figures = result.score()
    assert (figures["cases"], figures["errors"]) == (COUNT, 0)
    assert figures["identifiable"] == sum(loop.identifiable for loop in loops())
    assert figures["delays_told"] == sum(loop.identifiable and loop.delay_told for loop in loops())
    for name in ("success", "within", "coverage", "delay", "delay_told", "honest"):
        assert figures[name] == 1.0, name
    assert figures["bias"] == pytest.approx(0.0, abs=1e-9)
    assert figures["efficiency"] == pytest.approx(0.0, abs=1e-9)


def test_errors_are_counted_in_expected_standard_errors():
    figures = run(lambda loop: Oracle(loop, 2.5)).score()
    assert (figures["success"], figures["coverage"], figures["honest"]) == (1.0, 0.0, 0.0)
    assert figures["bias"] == pytest.approx(2.5)
    assert figures["efficiency"] == pytest.approx(2.5)
    figures = run(lambda loop: Oracle(loop, -3.1)).score()
    assert (figures["success"], figures["within"], figures["bias"]) == (0.0, 0.0, None)


def test_a_refusal_is_honest_but_no_success():
    figures = run(lambda loop: Oracle(loop, 0.0, lm.Status.NOT_SEEN)).score()
    assert (figures["success"], figures["within"]) == (0.0, 1.0)
    figures = run(lambda loop: Oracle(loop, 9.0, lm.Status.CANNOT_TELL)).score()
    assert (figures["honest"], figures["refused"]) == (1.0, 1.0)


def test_exceptions_are_failures_with_their_text():
    def broken(loop):
        raise ZeroDivisionError("no more")

    result = run(broken)
    assert {case.error for case in result.cases} == {"ZeroDivisionError: no more"}
    figures = result.score()
    assert (figures["errors"], figures["success"], figures["coverage"], figures["honest"]) == (COUNT, 0.0, 0.0, 0.0)
    assert "case 3: ZeroDivisionError: no more" in result.summary()
    json.dumps(result.to_dict(), allow_nan=False)


def test_a_linear_fit_says_nothing_of_the_dead_zone():
    class Linear:
        status, parameters, standard_errors = lm.Status.OK, {"gain": 1.0}, {"gain": 0.1}
        linear = loops()[0].model.linear

    result = run(lambda loop: Linear())
    assert not any(case.usable or case.success for case in result.cases)
    assert result.score()["honest"] == 1.0


def test_groups_split_the_cases():
    result = run(lambda loop: Oracle(loop, 0.0))
    for split in (("open loop", "closed loop"), ("white noise", "coloured noise"), ("order 1", "order 2", "order 3"),
                  ("real poles", "complex poles", "integrating")):  # fmt: skip
        assert sum(result.score(group)["cases"] for group in split) == COUNT
    assert list(result.scores) == list(GROUPS)
    assert "group" in refusal(lm.ParameterError, result.score, "order 9")


def test_table_and_dictionary_hold_every_case():
    calls = []
    result = run(lambda loop: Oracle(loop, 1.0), progress=lambda done, total: calls.append((done, total)))
    assert calls == [(done, COUNT) for done in range(1, COUNT + 1)]
    table = result.table
    assert table.height == COUNT
    assert table["truth_left"].to_list() == [loop.truth["left"] for loop in loops()]
    assert table["delay_found"].to_list() == [loop.orders[2] for loop in loops()]
    data = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert (data["seed"], data["samples"], len(data["cases"])) == (1, SAMPLES, COUNT)
    assert data["scores"]["all"]["success"] == 1.0
    with pytest.raises(FrozenInstanceError):
        result.seed = 2


def test_a_group_without_cases_has_no_figures():
    figures = score([])
    assert figures["cases"] == 0
    assert set(figures.values()) == {0, None}
    assert MonteCarloResult((), 0, SAMPLES).summary().startswith("0 random loops")


def test_half_honest_is_not_honest():
    case: CaseResult = run(lambda loop: Oracle(loop, 0.0)).cases[0]
    assert case.honest
    high = case.intervals["right"][1]
    beside = replace(case, intervals={**case.intervals, "right": (high + 1.0, high + 2.0)})
    assert not beside.honest
    assert replace(beside, usable=False).honest


def test_refusals():
    assert "preset" in refusal(lm.ParameterError, monte_carlo, "huge")
    assert "cases" in refusal(lm.ParameterError, monte_carlo, cases=0)
    assert "workers" in refusal(lm.ParameterError, monte_carlo, cases=1, workers=0)


@pytest.mark.statistics
def test_processes_give_the_same_numbers():
    alone, side_by_side = (monte_carlo(cases=3, samples=SAMPLES, workers=workers) for workers in (1, 2))
    for one, other in zip(alone.cases, side_by_side.cases, strict=True):
        assert replace(one, seconds=0.0) == replace(other, seconds=0.0)


@pytest.mark.statistics
@pytest.mark.parametrize("index", [8, 26, 45, 56])
def test_identify_succeeds_on_easy_loops(index):
    case = measure(random_loop(index), lm.identify)
    assert (case.identifiable, case.success, case.delay_found) == (True, True, case.delay)
