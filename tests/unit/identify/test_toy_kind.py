"""A kind of actuator that only the tests know goes the whole way; what somebody forgets of one raises."""

import json
from dataclasses import asdict, dataclass
from typing import ClassVar

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.diagnose.diagnosis import verdicts
from lostmotion.identify.actuators import kind as kinds
from lostmotion.identify.actuators.kind import Kind, Words
from lostmotion.identify.likelihood.family import Family
from lostmotion.models import actuator_from_dict, registry
from tests.support.refusals import refusal

PROCESS = lm.LinearModel([-0.8], [0.3], 1, 1.0)


@dataclass(frozen=True)
class Relay:
    """An actuator that is pushed away from a place: x = u + height sign(u - place)."""

    place: float
    height: float
    kind: ClassVar[str] = "relay"
    own: ClassVar[tuple[str, ...]] = ("place", "height")
    size_name: ClassVar[str | None] = "height"

    def __call__(self, u):
        return np.asarray(u) + self.height * np.sign(np.asarray(u) - self.place)

    def to_dict(self):
        return {"kind": self.kind, **asdict(self)}

    @classmethod
    def from_dict(cls, data):
        return cls(data["place"], data["height"])


@dataclass(frozen=True)
class RelayFamily(Family):
    """Eta = place, height."""

    ends: tuple[float, float]
    kind: ClassVar[str] = "relay"
    own: ClassVar[tuple[str, ...]] = ("place", "height")
    kinks: ClassVar[bool] = True
    places: ClassVar[bool] = True

    def act(self, eta, u, x, dx):
        side = np.sign(u - eta[0])
        x[:], dx[0], dx[1] = u + eta[1] * side, 0.0, side

    def valid(self, eta):
        return np.array([min(max(eta[0], self.ends[0]), self.ends[1]), max(eta[1], 0.0)])

    def grid(self, u, span, rows):
        places = np.quantile(u, np.linspace(0.05, 0.95, 25))
        first = [np.array([place, height * span]) for place in places for height in (0.05, 0.2)]
        return first, lambda eta: [
            eta + span * np.array([move, rise]) for move in (-0.01, 0, 0.01) for rise in (0, 0.1)
        ]

    @classmethod
    def named(cls, own, scaling, product, gain):
        return cls.own, [scaling.u_centre + scaling.u_scale * own[0], scaling.u_scale * own[1]], 1.0


class RelayKind(Kind):
    """What the project needs to know of it, and nothing else."""

    model = Relay
    family = RelayFamily
    evidence = "dead_zone"
    angular = "always"
    break_points = ("place",)
    anywhere = ("place",)
    words = Words(
        wider="A relay higher than",
        plural="relays",
        measure="height",
        meanings={"place": "where it switches", "height": "how far it pushes"},
        advice=("Look for a magnet in the actuator.",),
    )

    def forms(self, data):
        return [RelayFamily((float(data.u.min()), float(data.u.max())))]


@pytest.fixture(autouse=True)
def relay():
    registry.actuator(Relay)
    kinds.register(RelayKind())
    yield
    kinds.forget("relay")
    registry.forget("relay")


def record(seed=0, n=900):
    rng = np.random.default_rng(seed)
    u = np.zeros(n)
    for k in range(1, n):
        u[k] = 0.9 * u[k - 1] + rng.normal(scale=0.8)
    y = PROCESS.simulate(Relay(0.4, 0.9)(u)) + rng.normal(scale=0.05, size=n)
    return lm.LoopRecord(u + 50.0, y, dt=1.0)


@pytest.mark.statistics
def test_identified_reported_drawn_and_written():
    fit = lm.identify(record(), nonlinearity="relay", orders=(1, 0, 1), noise="white")
    assert fit.status.ok
    assert isinstance(fit.nonlinearity, Relay)
    assert fit.parameters["place"] == pytest.approx(50.4, abs=0.05)
    assert fit.parameters["height"] == pytest.approx(0.9, abs=0.05)
    low, high = fit.interval("height")
    assert low < 0.9 < high
    said = fit.summary()
    assert "Relay of height" in said
    assert "where it switches" in said
    assert any(axes.get_title(loc="left").startswith("Relay") for axes in fit.plot().axes)
    written = json.loads(json.dumps(fit.to_dict(), allow_nan=False))
    assert actuator_from_dict(written["model"]["nonlinearity"]) == fit.nonlinearity


@pytest.mark.statistics
def test_told_from_the_other_kinds_and_diagnosed():
    fit = lm.identify(record(1), nonlinearity="auto")
    assert fit.kinds.best == "relay"
    found = lm.diagnose(record(1))
    assert found.verdict == "relay"
    assert found.verdict in verdicts()
    assert found.size == pytest.approx(0.9, abs=0.05)
    assert found.advice == RelayKind.words.advice
    assert "RELAY of" in found.summary()
    assert found.plot().axes
    json.dumps(found.to_dict(), allow_nan=False)


@pytest.mark.statistics
def test_it_has_no_block_and_no_loop_kernel_and_that_is_said():
    fit = lm.identify(record(), nonlinearity="relay", orders=(1, 0, 1), noise="white")
    assert "relay" in refusal(lm.ParameterError, fit.block, span=(0.0, 100.0)).lower()
    plant = lm.Hammerstein(fit.nonlinearity, PROCESS)
    assert "Relay" in refusal(lm.ParameterError, lm.simulate_loop, plant, lm.PI(0.1, 0.1), np.ones(50))


def test_without_it_the_name_is_unknown():
    kinds.forget("relay")
    assert "relay" in refusal(lm.ParameterError, lm.identify, record(), nonlinearity="relay")
    assert "relay" in refusal(lm.ParameterError, kinds.kind_of, "relay")
    registry.forget("relay")
    refusal(lm.ParameterError, actuator_from_dict, Relay(0.0, 1.0).to_dict())


@pytest.mark.parametrize("part", ["model", "family", "words", "evidence", "angular"])
def test_a_kind_without_a_part_is_refused(part):
    parts = {name: getattr(RelayKind, name) for name in ("model", "family", "words", "evidence", "angular")}
    del parts[part]
    forgetful = type("Forgetful", (Kind,), {**parts, "forms": RelayKind.forms})
    kinds.forget("relay")
    assert part in refusal(lm.ParameterError, kinds.register, forgetful())


@pytest.mark.parametrize(
    ("name", "value"),
    [("evidence", "magnetism"), ("angular", "sometimes"), ("nests", "nobody"), ("words", Words()), ("family", Family)],
)
def test_a_kind_with_a_wrong_part_is_refused(name, value):
    if name == "family":
        value = type("Other", (RelayFamily,), {"kind": "other"})
    wrong = type("Wrong", (RelayKind,), {name: value})
    kinds.forget("relay")
    refusal(lm.ParameterError, kinds.register, wrong())


def test_a_kind_that_does_not_say_its_forms_cannot_be_made():
    forgetful = type("Forgetful", (Kind,), {"model": Relay})
    with pytest.raises(TypeError, match="forms"):
        forgetful()


def test_a_family_without_a_grid_raises_where_it_is_sought():
    silent = type("Silent", (RelayFamily,), {"grid": Family.grid})
    kinds.forget("relay")
    kinds.register(type("Blind", (RelayKind,), {"forms": lambda self, data: [silent((-9.0, 9.0))]})())
    with pytest.raises(NotImplementedError, match="no grid"):
        lm.identify(record(), nonlinearity="relay", orders=(1, 0, 1), noise="white")


def test_a_name_is_taken_once():
    refusal(lm.ParameterError, kinds.register, RelayKind())
    twin = type("Twin", (Relay,), {})
    refusal(lm.ParameterError, registry.actuator, twin)


@pytest.mark.parametrize("part", ["kind", "own", "size_name", "from_dict"])
def test_a_model_without_a_part_is_refused(part):
    parts = {name: getattr(Relay, name) for name in ("kind", "own", "size_name") if name != part}
    if part != "from_dict":
        parts["from_dict"] = Relay.from_dict
    assert part in refusal(lm.ParameterError, registry.actuator, type("Half", (), parts))
