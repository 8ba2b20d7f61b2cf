"""`[loop.block]` and `[supervision]` of a plant file: what they hold, and mistakes."""

import json

import pytest

from lostmotion.errors import DataError, FileAccessError
from lostmotion.live.plant_file import read_plant_file
from lostmotion.live.supervision.settings import refuse_other_scan
from tests.support.supervised import supervised

GOOD = """address = "opc.tcp://plc1:4840"

[supervision]
log = "requests.jsonl"
requests = "door"

[[loop]]
tag = "TIC1"
op = "ns=2;s=TY1.OP_OUT"
pv = "ns=2;s=TIC1.PV"
orders = [1, 0, 1]
dt = 0.5

[loop.block]
file = "ty1.json"
nodes = "ns=2;s=TY1."
write = true
adaptive = true
who = "anna"
least_change = 0.2
kp = 0.5
ki = 0.1
span = [0, 100]
"""


def written(folder, text=GOOD, kind="dead zone", **parts):
    data = supervised(kind).to_dict() | parts
    (folder / "ty1.json").write_text(json.dumps(data))
    path = folder / "plant.toml"
    path.write_text(text)
    return path


def test_a_block_is_read(tmp_path):
    plant = read_plant_file(written(tmp_path))
    (block,) = plant.blocks
    assert (block.tag, block.name, block.write, block.adaptive, block.who) == ("TIC1", "TIC1", True, True, "anna")
    assert (block.least_interval, block.least_change, block.study) == (3600.0, 0.2, {"span": (0, 100)})
    assert (block.controller.kp, block.controller.ki) == (0.5, 0.1)
    assert block.nodes["request_id"] == "ns=2;s=TY1.REQUEST_ID"
    assert block.timeout == block.block.settings["timeout"] * block.block.scan_time
    assert (plant.supervision.log, plant.supervision.requests) == (tmp_path / "requests.jsonl", tmp_path / "door")


def test_nothing_is_written_unless_it_is_said(tmp_path):
    plant = read_plant_file(written(tmp_path, GOOD.replace("write = true\n", "")))
    assert not plant.blocks[0].write


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ('log = "requests.jsonl"\nrequests = "door"', 'requests = "door"', "log"),
        ('[supervision]\nlog = "requests.jsonl"\nrequests = "door"\n', "", "[supervision]"),
        ('op = "ns=2;s=TY1.OP_OUT"', 'op = "ns=2;s=TIC1.OP"', "what goes to the valve"),
        ("kp = 0.5\n", "", "kp"),
        ("write = true", 'write = "yes"', "true or false"),
        ("least_change", "least_chnage", "least_chnage"),
        ("least_change = 0.2", "least_interval = 0", "least_interval"),
        ("least_change = 0.2", "least_change = nan", "least_change"),
        ('nodes = "ns=2;s=TY1."', 'nodes = {op_out = "ns=2;s=TY1.OP_OUT"}', "a node for op_in"),
        ('who = "anna"', 'password = "x"', "no secret"),
        ("[supervision]", "[defaults]\nblock = {}\n[supervision]", "block"),
    ],
)
def test_mistakes_are_named(tmp_path, before, after, said):
    assert before in GOOD
    with pytest.raises(DataError) as caught:
        read_plant_file(written(tmp_path, GOOD.replace(before, after)))
    assert said in str(caught.value)


def test_only_a_supervised_block_of_the_kind_is_taken(tmp_path):
    path = written(tmp_path, kind="backlash")
    with pytest.raises(DataError, match="adaptive beside a block for a dead zone"):
        read_plant_file(path)
    assert read_plant_file(written(tmp_path, GOOD.replace("adaptive = true", ""), kind="backlash")).blocks
    for parts in ({"supervision": {"timeout": 0}}, {"supervision": {"odd": 1}}, {"settings": []}):
        with pytest.raises(DataError, match="supervised block"):
            read_plant_file(written(tmp_path, **parts))
    (tmp_path / "ty1.json").write_text(json.dumps(supervised("dead zone").block.to_dict()))
    with pytest.raises(DataError, match="without supervision"):
        read_plant_file(tmp_path / "plant.toml")
    (tmp_path / "ty1.json").unlink()
    with pytest.raises(FileAccessError):
        read_plant_file(tmp_path / "plant.toml")


def test_the_loop_is_sampled_at_the_scan_of_its_block(tmp_path):
    block = read_plant_file(written(tmp_path)).blocks[0]
    refuse_other_scan(block, block.block.scan_time)
    with pytest.raises(DataError, match="the scan of the block"):
        refuse_other_scan(block, 2.0 * block.block.scan_time)
