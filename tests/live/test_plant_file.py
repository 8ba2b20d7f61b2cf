"""A plant file: what it may hold, and what each mistake is answered with."""

from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.errors import DataError, FileAccessError, GateError, ParameterError
from lostmotion.live.loop_settings import publishing_of
from lostmotion.live.plant_file import plant_of, read_plant_file

GOOD = """
address = "opc.tcp://plc1:4840"
[security]
user_file = "plc1.user"
[defaults]
dt = 1.0
orders = [3, 2, 3]
op_limits = [0, 100]
[[loop]]
tag = "FIC101"
op = "ns=2;s=FIC101.OP"
pv = "ns=2;s=FIC101.PV"
width_limit = 3.0
[[loop]]
tag = "FIC102"
op = "ns=2;s=FIC102.OP"
pv = "ns=2;s=FIC102.PV"
mode = "ns=2;s=FIC102.MODE"
automatic = ["AUTO"]
orders = [1, 0, 1]
dt = 0.1
"""


def written(folder, text):
    path = folder / "plant.toml"
    path.write_text(text)
    return path


def test_a_loop_has_the_defaults_and_what_it_says_itself(tmp_path):
    plant = read_plant_file(written(tmp_path, GOOD))
    first, second = plant.loops
    assert plant.address == "opc.tcp://plc1:4840"
    assert plant.security == {"user_file": "plc1.user"}
    assert (first.dt, first.orders, first.watch, first.width_limit) == (1.0, (3, 2, 3), {"op_limits": (0, 100)}, 3.0)
    assert (second.dt, second.orders, second.automatic) == (0.1, (1, 0, 1), ("AUTO",))
    assert second.nodes == {"op": "ns=2;s=FIC102.OP", "pv": "ns=2;s=FIC102.PV", "mode": "ns=2;s=FIC102.MODE"}
    model = first.model()
    assert (model.dt, model.settings["na"], model.settings["delay"], model.accepted) == (1.0, 3, 3, "")


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('tag = "FIC102"', 'tag = "FIC101"', "each tag once"),
        ('pv = "ns=2;s=FIC102.PV"\n', "", "loop[1].pv"),
        ("width_limit = 3.0", "widht_limit = 3.0", "widht_limit"),
        ("width_limit = 3.0", 'password = "x"', "no secret"),
        ('user_file = "plc1.user"', 'Password = "x"', "no secret"),
        ("dt = 0.1", "dt = -1", "loop[1].dt"),
        ("orders = [1, 0, 1]", "orders = [1, 0]", "loop[1].orders"),
        ("[defaults]", "[default]", "default"),
        ("dt = 0.1", "dt = ", "TOML"),
        ('address = "opc.tcp://plc1:4840"', "", "address"),
    ],
)
def test_mistakes_are_named(tmp_path, before, after, said):
    assert before in GOOD
    with pytest.raises(DataError) as caught:
        read_plant_file(written(tmp_path, GOOD.replace(before, after)))
    assert said in str(caught.value)
    assert "'x'" not in str(caught.value)


def test_no_file(tmp_path):
    with pytest.raises(FileAccessError):
        read_plant_file(tmp_path / "none.toml")


def only(**loop):
    whole = {"tag": "A", "op": "ns=2;s=A.OP", "pv": "ns=2;s=A.PV", **loop}
    return plant_of({"address": "opc.tcp://plc:4840", "loop": [whole]}, Path()).loops[0]


def test_a_loop_needs_orders_or_a_fit_and_a_sampling_time():
    with pytest.raises(ParameterError, match="orders or a fit"):
        only(dt=1.0).model()
    with pytest.raises(ParameterError, match="dt of loop 'A'"):
        only(orders=[1, 0, 1]).model()


def test_messages_come_four_times_a_sample_within_bounds():
    assert [publishing_of([dt, 60.0]) for dt in (0.1, 1.0, 10.0)] == [0.1, 0.25, 0.5]


def test_the_gate_is_that_of_online(tmp_path):
    loop = lm.routine_operation(1500, drift="none", seed=0)
    for kind in ("none", "dead zone"):
        fit = lm.identify(loop.command, loop.measured, 0.1, nonlinearity=kind, orders=(3, 2, 3))
        fit.save(tmp_path / f"{kind}.json")
    with pytest.raises(GateError, match="shows a dead zone"):
        only(fit=str(tmp_path / "none.json")).model()
    model = only(fit=str(tmp_path / "dead zone.json")).model()
    assert (model.dt, model.settings["na"], model.settings["delay"]) == (0.1, 3, 3)
    with pytest.raises(ParameterError, match="a fit at dt"):
        only(fit=str(tmp_path / "dead zone.json"), dt=1.0).model()
