"""identify() with every kind of actuator: recovery, intervals, choice, texts."""

import json
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import ParameterError, Status
from lostmotion.evaluate.random_faults import random_faulty_loop
from tests.support.refusals import refusal

VALVES = {
    "backlash": lm.Backlash(1.5),
    "stiction": lm.Stiction(2.0, 1.0),
    "saturation": lm.Saturation(49.0, 51.2),
    "dead zone": lm.DeadZone(49.4, 50.6),
}
PROCESSES = {
    "regulating": lm.LinearModel([-0.8], [0.3], 1, 1.0),
    "integrating": lm.LinearModel([-1.0], [0.1], 2, 1.0),
}
SIZE = {"backlash": "width", "stiction": "band", "dead zone": "width"}
KINDS = tuple(VALVES)


def moved(n=600, seed=0, rest=50.0):
    """A command that wanders about its rest: every valve turns in it many times."""
    rng = np.random.default_rng(seed)
    walk = np.zeros(n)
    for k in range(1, n):
        walk[k] = 0.97 * walk[k - 1] + rng.normal(scale=0.5)
    return rest + walk


def open_loop(kind, process="regulating", deviation=0.0, n=600, seed=0):
    u = moved(n, seed)
    x = np.asarray(VALVES[kind](u)) - (50.0 if process == "integrating" and kind != "dead zone" else 0.0)
    y = PROCESSES[process].simulate(x)
    return u, y + np.random.default_rng(seed + 1000).normal(scale=deviation, size=n) if deviation else y


def closed_loop(kind, process, n=800):
    """Set points that move, about zero, without noise."""
    linear = PROCESSES[process]
    valve = {
        "backlash": lm.Backlash(1.5),
        "stiction": lm.Stiction(2.0, 1.0),
        "saturation": lm.Saturation(-1.0, 1.4),
        "dead zone": lm.DeadZone(-0.6, 0.6),
    }[kind]
    reference = np.repeat(np.random.default_rng(3).normal(scale=2.0, size=n // 20), 20)
    controller = lm.PI(0.4, 0.15, -50, 50) if process == "regulating" else lm.PI(1.2, 0.03, -50, 50)
    loop = lm.simulate_loop(lm.Hammerstein(valve, linear), controller, reference, allow_unstable=True)
    return valve, loop


def check(fit, valve, linear):
    """Actuator and process, and all of PV."""
    kind = valve.kind
    names = {"backlash": ["width"], "saturation": ["low", "high"], "dead zone": ["left", "right"], "stiction": []}[kind]
    for name in names:
        assert fit.parameters[name] == pytest.approx(getattr(valve, name), rel=1e-3, abs=1e-3), name
    if kind == "stiction":  # a band that leaves all break-aways in their samples does as well; x tells band - jump
        assert fit.parameters["band"] == pytest.approx(valve.band, rel=0.02)
        glide = fit.parameters["band"] - fit.parameters["jump"]
        assert glide == pytest.approx(valve.band - valve.jump, abs=2e-3)
    np.testing.assert_allclose(fit.linear.a, linear.a, atol=2e-4)
    np.testing.assert_allclose(fit.linear.b, linear.b, atol=2e-4)
    assert fit.nonlinearity.kind == kind
    assert fit.fit_percent > 99.9


@pytest.mark.statistics
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("kind", KINDS)
def test_exact_recovery_in_open_loop(kind, process):
    linear = PROCESSES[process]
    u, y = open_loop(kind, process)
    orders = (1, 0, linear.delay)
    check(lm.identify(u, y, 1.0, nonlinearity=kind, orders=orders, noise="white"), VALVES[kind], linear)


@pytest.mark.statistics
@pytest.mark.parametrize("process", PROCESSES)
@pytest.mark.parametrize("kind", KINDS)
def test_exact_recovery_in_closed_loop(kind, process):
    valve, loop = closed_loop(kind, process)
    linear = PROCESSES[process]
    orders = (1, 0, linear.delay)
    fit = lm.identify(loop.control, loop.measured, 1.0, nonlinearity=kind, orders=orders, noise="white")
    check(fit, valve, linear)


def test_small_record_of_backlash():
    """Quick also with the JIT off."""
    u = moved(120)
    y = PROCESSES["regulating"].simulate(np.asarray(lm.Backlash(1.5)(u)))
    fit = lm.identify(u, y, 1.0, nonlinearity="backlash", orders=(1, 0, 1), noise="white")
    assert fit.parameters["width"] == pytest.approx(1.5, rel=1e-3)


@pytest.mark.statistics
@pytest.mark.parametrize("rest", [-0.9, -0.3, 0.6])
def test_a_valve_that_rests_anywhere_in_its_band(rest):
    u = moved(700)
    u[:150] = u[150] + 0.01 * np.sin(np.arange(150.0))  # it stays there, as stiff valves do
    valve = VALVES["stiction"]
    x = np.asarray(valve.run(u, start=u[0] + 0.5 * rest * (valve.band + valve.jump)))
    y = PROCESSES["regulating"].simulate(x) + np.random.default_rng(1).normal(scale=0.02, size=u.size)
    fit = lm.identify(u, y, 1.0, nonlinearity="stiction", orders=(1, 0, 1))
    assert fit.parameters["band"] == pytest.approx(valve.band, rel=0.03)
    assert fit.parameters["jump"] == pytest.approx(valve.jump, rel=0.1)


@pytest.mark.statistics
def test_polish_reaches_the_best_of_a_fine_grid():
    u, y = open_loop("backlash", deviation=0.1)
    fit = lm.identify(u, y, 1.0, nonlinearity="backlash", orders=(1, 0, 1), noise="white")
    best = np.inf
    for width in np.linspace(1.0, 2.0, 201):  # x is known: an output-error fit of order one each
        x = lm.Backlash(width)(u)
        known = lm.identify(x, y, 1.0, nonlinearity="none", orders=(1, 0, 1), noise="white")
        best = min(best, float(np.sum(known.residuals**2)))
    assert float(np.sum(fit.residuals**2)) <= best * (1.0 + 2.0 / u.size)


@pytest.mark.long
@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["backlash", "stiction"])
def test_profile_interval_covers_and_shrinks(kind):
    widths = {}
    for n in (400, 3200):
        inside, reach = 0, []
        for seed in range(6):
            u, y = open_loop(kind, deviation=0.3, n=n, seed=seed)
            fit = lm.identify(u, y, 1.0, nonlinearity=kind, orders=(1, 0, 1), noise="white")
            low, high = fit.interval(SIZE[kind])
            truth = getattr(VALVES[kind], SIZE[kind])
            assert low <= fit.parameters[SIZE[kind]] <= high
            inside += low <= truth <= high
            reach.append(high - low)
        assert inside >= 4  # of 6 at 95 %: less happens once in 450 times
        widths[n] = np.median(reach)
    assert widths[3200] < 0.6 * widths[400]


@pytest.mark.statistics
def test_interval_is_open_where_the_record_does_not_bound_it():
    rng = np.random.default_rng(0)
    u = np.repeat([50.0, 52.0], 150)  # one move, no turn
    y = PROCESSES["regulating"].simulate(u - 50.0) + rng.normal(scale=0.05, size=300)
    fit = lm.identify(u, y, 1.0, nonlinearity="backlash", orders=(1, 0, 1), noise="white")
    low, high = fit.interval("width")
    assert fit.status in (Status.NOT_SEEN, Status.CANNOT_TELL)
    assert low == 0.0
    assert high > 1.0  # half of the move at least


@pytest.mark.statistics
def test_interval_at_other_levels():
    u, y = open_loop("stiction", deviation=0.1)
    fit = lm.identify(u, y, 1.0, nonlinearity="stiction", orders=(1, 0, 1))
    for name in ("band", "jump"):
        ends = [fit.interval(name, level) for level in (0.5, 0.95, 0.99)]
        assert ends[1] == pytest.approx(fit.profiled[name])
        assert ends[0][0] >= ends[1][0] >= ends[2][0] >= 0.0
        assert ends[0][1] <= ends[1][1] <= ends[2][1]
        assert fit.standard_errors[name] == pytest.approx((ends[1][1] - ends[1][0]) / 3.92, rel=1e-9)
    assert "0 < level < 1" in refusal(ParameterError, fit.interval, "band", 1.0)
    assert "one of" in refusal(ParameterError, fit.interval, "width")


@pytest.mark.statistics
@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_chosen_described_and_written(kind):
    u, y = open_loop(kind, deviation=0.05)
    fit = lm.identify(u, y, 1.0, nonlinearity="auto")
    assert fit.nonlinearity.kind == fit.kinds.best == kind
    assert fit.preferred == kind
    assert fit.kinds.gains["none"] == 0.0
    assert 0.5 < fit.kinds.confidence <= 1.0
    text = fit.summary()
    assert kind in text.lower()
    said = " ".join(text.split())
    assert f"{kind} is the likeliest" in said
    assert "it predicts better than the linear model" in said
    doubted = replace(fit, status=Status.MISFIT, kinds=replace(fit.kinds, gains={**fit.kinds.gains, kind: -289.4}))
    said = " ".join(doubted.summary().split())
    assert "rows that were left out do not confirm this one" in said
    assert "among the kinds, which is not that of a fault). But rows that were left out it predicts worse" in said
    written = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    assert written["kinds"]["best"] == kind
    assert written["model"]["nonlinearity"]["kind"] == kind


@pytest.mark.statistics
@pytest.mark.parametrize("seed", range(3))
def test_a_linear_loop_has_no_fault(seed):
    rng = np.random.default_rng([seed, 1])  # not the numbers of which OP is made: PV would tell OP exactly
    u = moved(800, seed)
    y = PROCESSES["regulating"].simulate(u) + rng.normal(scale=0.2, size=800)
    fit = lm.identify(u, y, 1.0, nonlinearity="auto")
    assert fit.nonlinearity.kind == "none"
    assert fit.kinds.best == "none"
    assert 0.0 <= fit.kinds.confidence <= 1.0
    assert "no actuator fault" in fit.summary()
    json.dumps(fit.to_dict(), allow_nan=False)


@pytest.mark.statistics
def test_of_two_that_do_as_well_the_simpler_one():
    """Stiction without a jump is backlash."""
    u = moved(800, 4)
    y = PROCESSES["regulating"].simulate(np.asarray(lm.Stiction(1.5, 0.0)(u)))
    y += np.random.default_rng(4).normal(scale=0.05, size=800)
    fit = lm.identify(u, y, 1.0, nonlinearity="auto")
    assert fit.kinds.best == "backlash"
    assert fit.parameters["width"] == pytest.approx(1.5, rel=0.05)


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["backlash", "stiction", "saturation"])
def test_texts_of_every_status(kind):
    u, y = open_loop(kind, deviation=0.1)
    fit = lm.identify(u, y, 1.0, nonlinearity=kind, orders=(1, 0, 1))
    for status in Status:
        for widest in (None, 0.7, float("inf")):
            told = replace(fit, status=status, widest=widest)
            text = told.summary()
            assert text.startswith("record: 600 samples")
            assert "nan" not in text
            assert "None" not in text
            json.dumps(told.to_dict(), allow_nan=False)


@pytest.mark.statistics
@pytest.mark.parametrize("kind", ["backlash", "stiction"])
def test_what_is_not_seen_is_bounded(kind):
    u = moved(800, 7)
    y = PROCESSES["regulating"].simulate(u) + np.random.default_rng(70).normal(scale=0.1, size=800)
    fit = lm.identify(u, y, 1.0, nonlinearity=kind, orders=(1, 0, 1))
    assert fit.status is Status.NOT_SEEN
    assert 0.0 < fit.widest < 1.5
    assert fit.interval(SIZE[kind]) == (0.0, fit.widest)
    assert "would have been seen" in fit.summary()


@pytest.mark.statistics
def test_a_command_that_pv_foretells_bounds_nothing():
    """Noise of PV that is what moves OP: as behind a controller at a constant set point."""
    u = moved(800, 7)
    y = PROCESSES["regulating"].simulate(u) + np.random.default_rng(7).normal(scale=0.1, size=800)
    fit = lm.identify(u, y, 1.0, nonlinearity="backlash", orders=(1, 0, 1))
    assert fit.status is Status.NOT_SEEN
    assert fit.evidence.only_fed_back
    assert fit.widest is None
    assert "does not bound" in fit.summary()


def test_bad_input():
    u = moved(200)
    for wrong in ("hysteresis", "Backlash", "", None):
        assert "nonlinearity as one of" in refusal(ParameterError, lm.identify, u, u, 1.0, nonlinearity=wrong)


def visible(cause, count):
    """The first visible loops of a cause."""
    loops, seed = [], 1000
    while len(loops) < count:
        seed += 1
        loop = random_faulty_loop(seed, cause=cause)
        if loop.visible:
            loops.append(loop)
    return loops


@pytest.fixture(scope="module")
def random_fits():
    """Ten loops with backlash and ten with stiction, most of them at a constant set point."""
    return [
        (cause, loop, lm.identify(loop.op, loop.pv, loop.dt, nonlinearity="auto"))
        for cause in ("backlash", "stiction")
        for loop in visible(cause, 10)
    ]


def those_told(random_fits):
    return [(cause, loop, fit) for cause, loop, fit in random_fits if fit.nonlinearity.kind == cause]


@pytest.mark.long
@pytest.mark.statistics
def test_sizes_in_random_closed_loops(random_fits):
    told = those_told(random_fits)
    assert len(told) >= 12
    ratios = np.array([fit.parameters[SIZE[cause]] / loop.width for cause, loop, fit in told])
    assert np.mean(np.abs(ratios - 1.0) < 0.15) >= 0.85


@pytest.mark.statistics
def test_intervals_in_random_closed_loops(random_fits):
    inside = []
    for cause, loop, fit in those_told(random_fits):
        low, high = fit.interval(SIZE[cause])
        inside.append(low <= loop.width <= high)
    assert np.mean(inside) >= 0.75


@pytest.mark.statistics
def test_kinds_in_random_closed_loops(random_fits):
    assert np.mean([fit.nonlinearity.kind == cause for cause, _, fit in random_fits]) >= 0.9
